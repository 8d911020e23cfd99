#!/usr/bin/env python3
"""Fits the confidence of verification and writes src/verification/confidence_weights.inc.

Each set is a folder that `evaluate` wrote with {reprojection_verification: {exhaustive: true}}, so that every hypothesis
was compared in full. A set may be halved: FOLDER:0 takes the even frames, FOLDER:1 the odd ones (scene + frame); and
weighted: FOLDER@3 or FOLDER:0@3 counts three times, for real sets, which are small.
--fit sets decide, --check sets are reported only:

  fit_confidence.py --fit wide1 wide2 shelf:0 tote:0 negative:0 --check shelf:1 tote:1 negative:1 --write INC

--compare shows how well each item of the evidence tells right from wrong in groups of sets, and fits nothing:

  fit_confidence.py --compare simulated=wide1,wide2 real=shelf,tote

--store writes the evidence of the --check sets as test/data/evidence/held_out.csv, against which a test holds the weights: all that
is right or has a confidence from 0.001 on, and every fifth of the rest.

A hypothesis is right if it lies within 20 mm and 12 degrees of a true instance of its object. Two kinds count neither
way, as the choice among hypotheses decides them: one within 50 mm of its object but rotated, and one within 15 mm of
another object, its twin. The model is logistic regression with weights that are not negative, a weak pull to
zero, and wrong hypotheses that weigh half as much again, as a false object is worse than a missed one.
"""
import argparse
import json
import math
import os

import numpy as np

NEAR_DISTANCE, NEAR_ANGLE = 0.02, 12.0  # metres, degrees
SAME_PLACE, TWIN = 0.05, 0.015           # metres
WRONG_WEIGHT = 1.5
RIDGE = 1.0
NAMES = ['log_inliers', 'inliers', 'significance', 'structure', 'peak', 'color_distance', 'depth_fit', 'segment_share',
         'illumination_change']
SOURCES = {'CONSENSUS': ('consensus', 'alternative'), 'PROPOSAL': ('correspondence', 'shape')}


def inputs(e):
    """As confidenceInputs() in src/verification/confidence.cpp."""
    return [math.log1p(e['inliers']), min(40, e['inliers']) / 10, math.log1p(e['significance']), e['structure'], max(-0.2, min(0.5, e['peak'])),
            -e['color_distance'] / 10, e['depth_fit'], e['segment_share'], -e['illumination_change'] / 10]


def distance(a, b):
    return math.dist((a[3], a[7], a[11]), (b[3], b[7], b[11]))


def angle(a, b):
    trace = sum(a[4 * i + j] * b[4 * i + j] for i in range(3) for j in range(3))
    return math.degrees(math.acos(max(-1, min(1, (trace - 1) / 2))))


def label(hypothesis, truth):
    """True, False, or None for what counts neither way."""
    own = [t['pose'] for t in truth if t['object'] == hypothesis['object']]
    pose = hypothesis['pose']
    if any(distance(pose, t) < NEAR_DISTANCE and angle(pose, t) < NEAR_ANGLE for t in own):
        return True
    if any(distance(pose, t) < SAME_PLACE for t in own):
        return None
    return None if any(distance(pose, t['pose']) < TWIN for t in truth) else False


def labelled(name, sources):
    """Compared hypotheses of a set that count as right or wrong."""
    name = name.partition('@')[0]
    folder, _, half = name.partition(':')
    with open(os.path.join(folder, 'frames.jsonl')) as lines:
        for line in lines:
            record = json.loads(line)
            if half and (7 * record['scene'] + record['frame']) % 2 != int(half):
                continue
            for hypothesis in record['hypotheses']:
                if hypothesis['level'] != 'compared' or hypothesis['source'] not in sources:
                    continue
                right = label(hypothesis, record['truth'])
                if right is not None:
                    yield hypothesis, right


def read(name, sources):
    pairs = list(labelled(name, sources))
    x = [inputs(hypothesis['evidence']) for hypothesis, _ in pairs]
    return np.array(x).reshape(-1, len(NAMES)), np.array([right for _, right in pairs], dtype=float)


def weight_of(name, macro):
    """Real sets hold too few right proposals for a weight of their own."""
    return float(name.partition('@')[2] or 1) if macro == 'CONSENSUS' else 1.0


def fit(x, y, weight, iterations=30000):
    """Projected gradient descent on standardised inputs."""
    mean, scale = x.mean(0), x.std(0) + 1e-6
    z = (x - mean) / scale
    weight = weight * np.where(y == 1, 1.0, WRONG_WEIGHT)
    weight /= weight.sum()
    w, b = np.zeros(z.shape[1]), 0.0
    for _ in range(iterations):
        error = (1 / (1 + np.exp(-(z @ w + b))) - y) * weight
        w = np.maximum(0, w - (z.T @ error + RIDGE * w / len(y)))
        b -= error.sum()
    w = w / scale
    return w, b - float(w @ mean)


def report(kind, name, x, y, w, b):
    p = 1 / (1 + np.exp(-(x @ w + b)))
    kept = [f'>{t}: {int(((p > t) & (y == 1)).sum())}/{int(((p > t) & (y == 0)).sum())}' for t in (0.5, 0.7, 0.9)]
    print(f'  {kind:7} {name:40} right {int(y.sum()):4} wrong {int((1 - y).sum()):5}; right/wrong {"  ".join(kept)}')


def area(values, y):
    """Under the curve: the chance that a right one has a larger value than a wrong one, ties half."""
    right, wrong = values[y == 1], values[y == 0]
    if not len(right) or not len(wrong):
        return float('nan')
    wrong = np.sort(wrong)
    below, up_to = np.searchsorted(wrong, right, 'left'), np.searchsorted(wrong, right, 'right')
    return float((below + up_to).mean() / (2 * len(wrong)))


STORED = ['inliers', 'significance', 'structure', 'peak', 'color_distance', 'depth_fit', 'segment_share', 'illumination_change']


def store(sets, file):
    """Items of evidence as measured; the confidence itself is left to who reads them."""
    kept, plain = [], 0
    for name in sets:
        folder, _, half = name.partition(':')
        title = os.path.basename(folder) + {'0': '_even', '1': '_odd'}.get(half, '')
        for hypothesis, right in labelled(name, sum(SOURCES.values(), ())):
            plain += not right and hypothesis['confidence'] < 0.001
            if right or hypothesis['confidence'] >= 0.001 or plain % 5 == 0:
                kept.append([title, hypothesis['source'], str(int(right))] + [f"{hypothesis['evidence'][n]:.4g}" for n in STORED])
    with open(file, 'w') as out:
        out.write('\n'.join(','.join(row) for row in [['set', 'source', 'right'] + STORED] + kept) + '\n')


def compare(groups):
    """Prints a table a kind of source: area under the curve, and median of the right ones, by item and group."""
    for macro, sources in SOURCES.items():
        data = {}
        for group in groups:
            title, _, names = group.partition('=')
            parts = [read(name, sources) for name in names.split(',')]
            data[title] = np.vstack([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
        print(f"{macro.lower()}: " + ', '.join(f'{t} {int(y.sum())} right, {int((1 - y).sum())} wrong' for t, (_, y) in data.items()))
        print('| item | ' + ' | '.join(f'{t}: area | median of right' for t in data) + ' |')
        print('| --- |' + ' --- |' * (2 * len(data)))
        for i, name in enumerate(NAMES):
            cells = []
            for x, y in data.values():
                right = x[y == 1, i]
                cells += [f'{area(x[:, i], y):.2f}', f'{np.median(right):.2f}' if len(right) else '']
            print(f'| {name} | ' + ' | '.join(cells) + ' |')
        print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--fit', nargs='+')
    parser.add_argument('--compare', nargs='+', metavar='GROUP=SET,SET')
    parser.add_argument('--check', nargs='*', default=[])
    parser.add_argument('--write', help='the table of weights')
    parser.add_argument('--store', metavar='CSV', help='the evidence of the --check sets')
    arguments = parser.parse_args()
    if arguments.compare:
        compare(arguments.compare)
        return
    if arguments.store:
        store(arguments.check, arguments.store)
        return
    if not arguments.fit:
        parser.error('--fit, --compare or --store says what to do')
    names = [os.path.basename(name) for name in arguments.fit]
    text = ['// Weights of confidence(): intercept, then one weight an input in the order of confidenceInputs().',
            '// Written by scripts/fit_confidence.py --fit ' + ' '.join(names) + '.']
    for macro, sources in SOURCES.items():
        parts = [read(name, sources) for name in arguments.fit]
        x, y = np.vstack([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
        weight = np.concatenate([np.full(len(p[1]), weight_of(n, macro)) for p, n in zip(parts, arguments.fit)])
        w, b = fit(x, y, weight)
        print(macro.lower(), f'{len(y)} hypotheses, {int(y.sum())} right; intercept {b:.2f};',
              ', '.join(f'{n} {v:.2f}' for n, v in zip(NAMES, w)))
        for kind, sets in (('fitted', arguments.fit), ('checked', arguments.check)):
            for name in sets:
                report(kind, os.path.basename(name), *read(name, sources), w, b)
        text += [f'#ifdef RGBD_{macro}_WEIGHTS', f'// {len(y)} hypotheses, {int(y.sum())} of them right.',
                 '{%.3f, {{%s}}}' % (b, ', '.join(f'{v:.3f}' for v in w)), '#endif']
    if arguments.write:
        with open(arguments.write, 'w') as out:
            out.write('\n'.join(text) + '\n')


if __name__ == '__main__':
    main()
