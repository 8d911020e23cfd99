"""Fits the confidence of verification (src/verification/confidence.cpp) on evaluated simulated sets.

Give the frames.jsonl that `evaluate` wrote with a low threshold (reprojection_verification: {min_confidence: 0.03}), so
that nearly all hypotheses competed, for several sets. Only those that no better explanation took the pixels of count:
what is left to the confidence. A hypothesis is right if it is near a true instance of its object; one that is at the
right place but turned or shifted counts neither way. With --suggestions, for the poses that single correspondences
suggest (those by shape use the same). Prints intercept and weights, and the reliability of the fit on the sets given
with --check (others than those fitted on).
"""
import argparse
import json
import math

import numpy as np

NEAR_DISTANCE, NEAR_ANGLE = 0.02, 10.0  # metres, degrees
PLACE = 0.03  # metres
NAMES = ['log_inliers', 'structure', 'color_distance', 'light_change', 'depth_fit', 'segment_share', 'texture']


def inputs(evidence):
    """As confidenceInputs() in src/verification/confidence.cpp."""
    return [math.log1p(evidence['inliers']), evidence['structure'], evidence['color_distance'] / 10,
            evidence['light_change'] / 10, evidence['depth_fit'], evidence['segment_share'], evidence['texture']]


def distance(a, b):
    return math.dist((a[3], a[7], a[11]), (b[3], b[7], b[11]))


def near(a, b):
    trace = sum(a[4 * i + j] * b[4 * i + j] for i in range(3) for j in range(3))
    return distance(a, b) < NEAR_DISTANCE and math.degrees(math.acos(max(-1, min(1, (trace - 1) / 2)))) < NEAR_ANGLE


def read(files, suggestions):
    rows, right = [], []
    for file in files:
        with open(file) as lines:
            for line in lines:
                record = json.loads(line)
                for h in record['hypotheses']:
                    if h['rejection'] not in ('none', 'consistency'):
                        continue  # refused by geometry, or for a better explanation
                    if h['evidence']['seen'] == 0:
                        continue  # no colour could have saved it, so none was compared
                    if h['source'] not in (['correspondence'] if suggestions else ['consensus', 'look_alike']):
                        continue
                    here = {t['object'] for t in record['truth'] if near(h['pose'], t['pose'])}
                    at_place = any(t['object'] == h['object'] and distance(h['pose'], t['pose']) < PLACE
                                   for t in record['truth'])
                    if h['object'] not in here and at_place:
                        continue
                    rows.append(inputs(h['evidence']))
                    right.append(h['object'] in here)
    return np.array(rows), np.array(right, dtype=float)


def fit(x, y, ridge):
    """Logistic regression by Newton's method, with a weak pull of the weights to zero."""
    design = np.hstack([np.ones((len(x), 1)), x])
    weights = np.zeros(design.shape[1])
    penalty = ridge * np.eye(design.shape[1])
    penalty[0, 0] = 0
    for _ in range(100):
        p = 1 / (1 + np.exp(-design @ weights))
        gradient = design.T @ (p - y) + penalty @ weights
        hessian = (design * (p * (1 - p))[:, None]).T @ design + penalty + 1e-9 * np.eye(len(weights))
        step = np.linalg.solve(hessian, gradient)
        weights -= step
        if np.abs(step).max() < 1e-8:
            break
    return weights


def reliability(weights, x, y):
    p = 1 / (1 + np.exp(-np.hstack([np.ones((len(x), 1)), x]) @ weights))
    print('confidence      hypotheses   mean   right')
    for low, high in zip([0, .1, .3, .5, .7, .9, .95, .99], [.1, .3, .5, .7, .9, .95, .99, 1.01]):
        inside = (p >= low) & (p < high)
        if inside.any():
            print('%.2f .. %.2f  %10d  %6.3f  %6.3f' % (
                low, min(high, 1), inside.sum(), p[inside].mean(), y[inside].mean()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--fit', nargs='+', required=True, help='frames.jsonl of simulated sets to fit on')
    parser.add_argument('--check', nargs='*', default=[], help='frames.jsonl of other simulated sets')
    parser.add_argument('--suggestions', action='store_true', help='fit what is for suggestions')
    arguments = parser.parse_args()
    x, y = read(arguments.fit, arguments.suggestions)
    weights = fit(x, y, 0.1 if arguments.suggestions else 1.0)
    print('%d hypotheses, %d of them right' % (len(y), int(y.sum())))
    print('intercept %.2f' % weights[0])
    for name, weight in zip(NAMES, weights[1:]):
        print('%-15s %.2f' % (name, weight))
    print('on the sets fitted on:')
    reliability(weights, x, y)
    if arguments.check:
        print('on the others:')
        reliability(weights, *read(arguments.check, arguments.suggestions))


if __name__ == '__main__':
    main()
