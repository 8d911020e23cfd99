#!/usr/bin/env python3
"""A manager that is killed comes back with its models; stages in processes of their own find the same objects."""
import os
import signal
import sys
import threading
import unittest
import xmlrpc.client

import rosgraph
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


def pid_of(node):
    return xmlrpc.client.ServerProxy(rosgraph.Master('/faults_test').lookupNode(node)).getPid('/faults_test')[2]


class FaultsTest(unittest.TestCase):
    def test_a_killed_manager_comes_back(self):
        self.kill_the_manager()

    def test_it_comes_back_if_no_bond_breaks(self):
        rospy.set_param('/bond_disable_heartbeat_timeout', True)
        try:
            self.kill_the_manager()
        finally:
            rospy.delete_param('/bond_disable_heartbeat_timeout')

    def kill_the_manager(self):
        with Camera():
            self.assertGreaterEqual(found_by('/recognition'), OBJECTS)
            before = pid_of('/recognition/manager')
            os.kill(before, signal.SIGKILL)
            self.assertGreaterEqual(found_by('/recognition'), OBJECTS)
        self.assertNotEqual(pid_of('/recognition/manager'), before)

    def test_stages_in_processes_of_their_own(self):
        with Camera():
            self.assertGreaterEqual(found_by('/apart'), OBJECTS)


if __name__ == '__main__':
    rospy.init_node('faults_test')
    rostest.rosrun('rgbd_recognition', 'faults', FaultsTest, sys.argv)
