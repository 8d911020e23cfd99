#!/usr/bin/env python3
"""Two cameras side by side: each object's tf frame has one parent, and tf can be switched off."""
import collections
import sys
import threading
import unittest

import rospy
import rostest
from geometry_msgs.msg import PoseArray
from recorded_camera import Camera
from rgbd_recognition.msg import DetectionArray
from tf2_msgs.msg import TFMessage

PATIENCE = 90.0  # seconds


class TwoCamerasTest(unittest.TestCase):
    def setUp(self):
        self.parents = collections.defaultdict(set)  # of each tf frame
        self.frames = collections.defaultdict(set)  # of each pipeline's detections
        self.poses = 0
        self.changed = threading.Condition()
        self.subscribers = [rospy.Subscriber('/tf', TFMessage, self.receive_tf, queue_size=100),
                            rospy.Subscriber('/silent/poses', PoseArray, self.receive_poses, queue_size=10)]
        for name in ('recognition_left', 'recognition_right', 'silent'):
            self.subscribers.append(rospy.Subscriber('/%s/detections' % name, DetectionArray, self.receive_detections,
                                                     callback_args=name, queue_size=10))

    def tearDown(self):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def receive_tf(self, message):
        with self.changed:
            for transform in message.transforms:
                self.parents[transform.child_frame_id].add(transform.header.frame_id)
            self.changed.notify_all()

    def receive_poses(self, message):
        with self.changed:
            self.poses = max(self.poses, len(message.poses))
            self.changed.notify_all()

    def receive_detections(self, message, name):
        with self.changed:
            self.frames[name].update(detection.frame for detection in message.detections)
            self.changed.notify_all()

    def wait_for(self, condition):
        with self.changed:
            return self.changed.wait_for(condition, PATIENCE)

    def test_each_frame_has_one_parent(self):
        def frame_of(name):
            def spoil(frame):
                for message in frame.values():
                    message.header.frame_id = name
            return spoil
        wanted = {'recognition_left/003_cracker_box_0', 'recognition_right/003_cracker_box_0'}
        with Camera(frame_of('left_optical'), camera='left'), Camera(frame_of('right_optical'), camera='right'):
            self.assertTrue(self.wait_for(lambda: wanted <= set(self.parents)), dict(self.parents))
            self.assertTrue(self.wait_for(lambda: self.frames['silent'] and self.poses > 0), dict(self.frames))
        for frame, parents in self.parents.items():
            self.assertEqual(len(parents), 1, '%s has the parents %s' % (frame, parents))
            self.assertFalse(frame.startswith('silent'), frame)
        self.assertEqual(self.parents['recognition_left/003_cracker_box_0'], {'left_optical'})
        self.assertIn('recognition_left/003_cracker_box_0', self.frames['recognition_left'])
        self.assertEqual(self.frames['silent'], {''})


if __name__ == '__main__':
    rospy.init_node('two_cameras_test')
    rostest.rosrun('rgbd_recognition', 'two_cameras', TwoCamerasTest, sys.argv)
