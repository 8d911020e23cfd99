"""Compares the detections of a running pipeline with the ground truth of a recording, frame by frame.

Exits 0 only if every expected object was found within 3 cm and 20 degrees in every frame, and nothing else was found.
"""
import argparse
import csv
import json
import math
import sys
import threading

import rospy
from rgbd_recognition.msg import DetectionArray
from sensor_msgs.msg import Image

LARGEST_DISTANCE = 0.03  # metres
LARGEST_ANGLE = 20.0  # degrees


def read_truth(file, names):
    """{stamp in ms: {name: (rotation rows, translation)}}"""
    truth = {}
    with open(file) as lines:
        for row in csv.DictReader(lines):
            rotation = [float(row['R%d%d' % (i, j)]) for i in (1, 2, 3) for j in (1, 2, 3)]
            translation = [float(row[key]) for key in ('Tx', 'Ty', 'Tz')]
            truth.setdefault(round(1e3 * float(row['Ts'])), {})[names[row['dID']]] = (rotation, translation)
    return truth


def rotation_of(q):
    x, y, z, w = q.x, q.y, q.z, q.w
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]


def errors(detection, truth):
    """Distance in metres and angle in degrees."""
    position = detection.pose.pose.position
    distance = math.dist((position.x, position.y, position.z), truth[1])
    trace = sum(a * b for a, b in zip(rotation_of(detection.pose.pose.orientation), truth[0]))
    return distance, math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1.0) / 2.0))))


class Collector:
    """Keeps the first answer to each frame, and the annotated image of the frame with most detections."""

    def __init__(self, stamps):
        self.stamps = set(stamps)
        self.answers = {}  # written by ROS's threads, under `changed`
        self.image = None
        self.changed = threading.Condition()
        rospy.Subscriber('/recognition/detections', DetectionArray, self.on_detections, queue_size=10)
        rospy.Subscriber('/recognition/annotated', Image, self.on_image, queue_size=1)

    def on_detections(self, message):
        with self.changed:
            self.answers.setdefault(round(message.header.stamp.to_nsec() / 1e6), message.detections)
            self.changed.notify_all()

    def on_image(self, message):
        with self.changed:
            best = max(self.answers, key=lambda stamp: len(self.answers[stamp]), default=None)
            if self.image is None or best == round(message.header.stamp.to_nsec() / 1e6):
                self.image = message
            self.changed.notify_all()

    def wait(self, seconds):
        with self.changed:
            self.changed.wait_for(lambda: self.stamps <= set(self.answers) and self.image is not None, seconds)


def write_ppm(message, file):
    """Any of 8-bit rgb and bgr."""
    swap = message.encoding.startswith('bgr')
    with open(file, 'wb') as out:
        out.write(b'P6 %d %d 255\n' % (message.width, message.height))
        for v in range(message.height):
            row = bytearray(message.data[v * message.step:v * message.step + 3 * message.width])
            if swap:
                row[0::3], row[2::3] = row[2::3], row[0::3]
            out.write(row)


def compare(answers, truth):
    good = True
    print('%-12s %-28s %-10s %9s %8s %10s' % ('frame', 'object', 'result', 'distance', 'angle', 'confidence'))
    for stamp in sorted(truth):
        if stamp not in answers:
            print('%-12.1f no answer' % (stamp / 1e3))
            good = False
            continue
        found = {detection.object: detection for detection in answers[stamp]}
        for name, pose in sorted(truth[stamp].items()):
            if name not in found:
                print('%-12.1f %-28s %-10s' % (stamp / 1e3, name, 'MISSED'))
                good = False
                continue
            distance, angle = errors(found[name], pose)
            near = distance <= LARGEST_DISTANCE and angle <= LARGEST_ANGLE
            good = good and near
            print('%-12.1f %-28s %-10s %6.1f mm %5.1f deg %10.2f' % (
                stamp / 1e3, name, 'found' if near else 'WRONG POSE', 1e3 * distance, angle, found[name].confidence))
        for name in sorted(set(found) - set(truth[stamp])):
            print('%-12.1f %-28s %-10s' % (stamp / 1e3, name, 'FALSE'))
            good = False
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--truth', required=True, help="the challenge's CSV")
    parser.add_argument('--models', required=True, help='models_info.json with the names of the ids')
    parser.add_argument('--annotated', required=True, help='PPM to write')
    parser.add_argument('--timeout', type=float, default=120.0, help='seconds')
    arguments = parser.parse_args()

    with open(arguments.models) as file:
        names = {key: value['name'] for key, value in json.load(file).items()}
    truth = read_truth(arguments.truth, names)
    rospy.init_node('compare_with_truth', anonymous=True, disable_signals=True)
    collector = Collector(truth)
    collector.wait(arguments.timeout)
    if collector.image is not None:
        write_ppm(collector.image, arguments.annotated)
    return 0 if compare(collector.answers, truth) else 1


if __name__ == '__main__':
    sys.exit(main())
