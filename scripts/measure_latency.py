#!/usr/bin/env python3
"""Frames a second and latency from a camera's stamp to tf, stage by stage, while recognition runs:

    scripts/measure_latency.py [--namespace recognition] [--seconds 60]

Run it beside any launch file, e.g. kinect.launch device_id:=virtual:SCENE models:=STORE. Latency needs stamps of this
machine's clock.
"""
import argparse
import collections
import threading

import rospy
from rgbd_recognition.msg import DetectionArray, StageTiming
from tf2_msgs.msg import TFMessage


def line(name, values, scale=1e3, unit='ms'):
    values = sorted(values)
    if not values:
        return '%-26s none' % name
    return '%-26s median %7.1f  p95 %7.1f  max %7.1f %s' % (
        name, scale * values[len(values) // 2], scale * values[int(0.95 * (len(values) - 1))], scale * values[-1], unit)


class Listener:
    """What the topics tell; callbacks come from rospy's threads."""

    def __init__(self, namespace):
        self.lock = threading.Lock()
        self.stages = collections.defaultdict(list)
        self.tf = []
        self.answered = 0
        self.subscribers = [
            rospy.Subscriber('/%s/timing' % namespace, StageTiming, self.on_timing),
            rospy.Subscriber('/%s/detections' % namespace, DetectionArray, self.on_detections),
            rospy.Subscriber('/tf', TFMessage, self.on_tf)]

    def restart(self):
        with self.lock:
            self.stages.clear()
            self.tf, self.answered = [], 0

    def on_timing(self, message):
        with self.lock:
            self.stages[message.stage].append(message.seconds)

    def on_detections(self, _):
        with self.lock:
            self.answered += 1

    def on_tf(self, message):
        delay = (rospy.Time.now() - message.transforms[0].header.stamp).to_sec()
        with self.lock:
            self.tf.append(delay)

    def report(self, seconds):
        with self.lock:
            print('%.1f frames a second answered' % (self.answered / seconds))
            print(line('device stamp to tf', self.tf))
            for stage, values in self.stages.items():
                print(line(stage, values))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--namespace', default='recognition')
    parser.add_argument('--seconds', type=float, default=60)
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node('measure_latency', anonymous=True)
    listener = Listener(arguments.namespace)
    rospy.sleep(3)  # the pipeline starts when somebody listens
    listener.restart()
    rospy.sleep(arguments.seconds)
    listener.report(arguments.seconds)


if __name__ == '__main__':
    main()
