#!/usr/bin/env python3
"""kinect.launch beside a master on which an earlier launch left another calibration: poses are as without it."""
import math
import os
import subprocess
import sys
import tempfile
import threading
import unittest

PORT = '11438'
os.environ['ROS_MASTER_URI'] = 'http://localhost:' + PORT
import rosgraph
import rospy
from rgbd_recognition.msg import DetectionArray
from sensor_msgs.msg import CameraInfo

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENE = os.path.join(PACKAGE, 'test', 'data', 'demo', 'test_primesense', '000001')
OBJECT, PLACE = '003_cracker_box', (-0.098, 0.093, 1.144)  # metres, in the first frame; the second's differs by 6 mm
TOLERANCE = 0.03
STALE_FOCAL_LENGTH = 900  # pixels
STALE = '''image_width: 640
image_height: 480
camera_name: rgb_camera
camera_matrix: {rows: 3, cols: 3, data: [900, 0, 100, 0, 900, 100, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.3, 0, 0, 0, 0]}
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [900, 0, 100, 0, 0, 900, 100, 0, 0, 0, 1, 0]}
'''
LONGEST = 120.0  # seconds
STORE = sys.argv.pop(1)


def distance(detection):
    place = detection.pose.pose.position
    return math.dist((place.x, place.y, place.z), PLACE)


class StaleCalibrationTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.environment = dict(os.environ, ROS_HOME=self.folder)
        self.started = []
        self.start('rosmaster', '--core', '-p', PORT)
        while not rosgraph.is_master_online():
            rospy.rostime.wallsleep(0.1)

    def tearDown(self):
        for process in reversed(self.started):
            process.terminate()
            process.wait()

    def start(self, *command):
        log = open(os.path.join(self.folder, command[0] + '.log'), 'w')
        self.started.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))

    def test_poses_are_right(self):
        stale = os.path.join(self.folder, 'stale.yaml')
        with open(stale, 'w') as file:
            file.write(STALE)
        for camera in ('rgb', 'depth'):
            rospy.set_param('/camera/driver/%s_camera_info_url' % camera, 'file://' + stale)
        rospy.set_param('/camera/driver/device_id', 'virtual:/nowhere')
        rospy.init_node('stale_calibration_test', disable_signals=True)
        focal_lengths, found = set(), threading.Event()

        def on_detections(message):
            if any(each.object == OBJECT and distance(each) < TOLERANCE for each in message.detections):
                found.set()

        rospy.Subscriber('/camera/rgb/camera_info', CameraInfo, lambda info: focal_lengths.add(round(info.P[0])))
        rospy.Subscriber('/recognition/detections', DetectionArray, on_detections)
        self.start('roslaunch', 'rgbd_recognition', 'kinect.launch', 'models:=' + STORE, 'device_id:=virtual:' + SCENE)
        self.assertTrue(found.wait(LONGEST), '%s is not where it is; see %s' % (OBJECT, self.folder))
        self.assertEqual(len(focal_lengths), 1, focal_lengths)
        self.assertNotIn(STALE_FOCAL_LENGTH, focal_lengths)


if __name__ == '__main__':
    unittest.main()
