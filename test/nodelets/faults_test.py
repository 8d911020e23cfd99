#!/usr/bin/env python3
"""Stages in processes of their own find the objects."""
import sys
import threading
import unittest

import rospy
import rostest
from recorded_camera import Camera
from rgbd_recognition.msg import DetectionArray

OBJECTS = {'003_cracker_box', '004_sugar_box'}
PATIENCE = 90.0  # seconds


def found_by(namespace):
    """Objects of the first answer that holds all that are in the frame; of the last one otherwise."""
    names, complete = set(), threading.Event()

    def receive(message):
        names.clear()
        names.update(detection.object for detection in message.detections)
        if names >= OBJECTS:
            complete.set()

    subscriber = rospy.Subscriber(namespace + '/detections', DetectionArray, receive, queue_size=1)
    complete.wait(PATIENCE)
    subscriber.unregister()
    return set(names)


class FaultsTest(unittest.TestCase):
    def test_stages_in_processes_of_their_own(self):
        with Camera():
            self.assertGreaterEqual(found_by('/apart'), OBJECTS)


if __name__ == '__main__':
    rospy.init_node('faults_test')
    rostest.rosrun('rgbd_recognition', 'faults', FaultsTest, sys.argv)
