#!/usr/bin/env python3
"""The doctor on a healthy set-up and on broken ones: it must name what is broken, and nothing else."""
import struct
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from recorded_camera import COLOR, DEPTH, INFO, Camera

DOCTOR = roslib.packages.find_node('rgbd_recognition', 'doctor')[0]


def examine(*arguments):
    done = subprocess.run([DOCTOR, '--seconds', '4', *arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=60)
    return done.returncode, done.stdout


class DoctorTest(unittest.TestCase):
    def expect(self, text, spoil=lambda frame: None, silent=(), arguments=()):
        with Camera(spoil, silent):
            status, told = examine(*arguments)
        self.assertEqual(status, 1, told)
        wrong = [line for line in told.splitlines() if 'WRONG' in line]
        self.assertTrue(any(text in line for line in wrong), '%r is not in\n%s' % (text, told))
        return told

    def test_healthy(self):
        with Camera():
            for _ in range(3):  # the first frames of a loaded machine may take longer than the doctor looks
                status, told = examine()
                if status == 0:
                    break
        self.assertEqual(status, 0, told)
        self.assertIn('003_cracker_box', told)
        self.assertIn('all is well', told)

    def test_no_camera(self):
        status, told = examine()
        self.assertEqual(status, 1, told)
        self.assertIn('nobody publishes ' + COLOR, told)

    def test_no_depth(self):
        self.expect('nobody publishes ' + DEPTH, silent=[DEPTH])

    def test_depth_not_registered(self):
        def spoil(frame):
            frame[DEPTH].header.frame_id = 'camera_depth_optical_frame'
        self.expect('depth is not registered', spoil)

    def test_encoding(self):
        def spoil(frame):
            frame[COLOR].encoding = 'yuv999'
        self.expect("colour has encoding 'yuv999'", spoil)

    def test_stamps_apart(self):
        def spoil(frame):
            frame[DEPTH].header.stamp -= rospy.Duration(0.08)
        self.expect('stamps of colour and depth differ', spoil)

    def test_no_calibration(self):
        def spoil(frame):
            frame[INFO].P = [0.0] * 12
        self.expect('camera info has no calibration', spoil)

    def test_camera_of_another_resolution(self):
        def spoil(frame):
            frame[INFO].P = [2.0 * value for value in frame[INFO].P]
        self.expect('the principal point', spoil)

    def test_depth_in_another_unit(self):
        def spoil(frame):  # constant, as a frame may be spoilt again
            frame[DEPTH].encoding = '16UC1'
            frame[DEPTH].step = 2 * frame[DEPTH].width
            frame[DEPTH].data = struct.pack('<H', 100) * (frame[DEPTH].width * frame[DEPTH].height)
        self.expect('where nothing is recognised', spoil)

    def test_no_frame(self):
        def spoil(frame):
            frame[COLOR].header.frame_id = ''
        self.expect('colour has no frame_id', spoil)

    def test_depth_far_away(self):
        def spoil(frame):
            frame[DEPTH].encoding = '32FC1'
            frame[DEPTH].step = 4 * frame[DEPTH].width
            frame[DEPTH].data = struct.pack('<f', 900.0) * (frame[DEPTH].width * frame[DEPTH].height)
        told = self.expect('depth is from 9e+02 to 9e+02 m', spoil)
        self.assertNotIn('more light', told)

    def test_clock_behind(self):
        def spoil(frame):
            for message in frame.values():
                message.header.stamp -= rospy.Duration(30.0)
        with Camera(spoil):
            status, told = examine()
        self.assertIn("stamps are 30.", told)
        self.assertIn("behind this machine's clock", told)
        self.assertNotIn('all is well', told)

    def test_empty_store(self):
        self.expect('holds no models', arguments=['--namespace', 'empty'])

    def test_no_pipeline(self):
        self.expect('recognition does not run in /elsewhere/', arguments=['--namespace', 'elsewhere'])


if __name__ == '__main__':
    rospy.init_node('doctor_test')
    rostest.rosrun('rgbd_recognition', 'doctor', DoctorTest, sys.argv)
