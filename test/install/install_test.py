#!/usr/bin/env python3
"""The examples are built against an installation in a temporary folder, and run. BUILD names the build's folder."""
import glob
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEMO = os.path.join(PACKAGE, 'test', 'data', 'demo')
CMAKE = os.environ.get('CMAKE', 'cmake')
ROS_VARIABLES = re.compile('ROS_|CMAKE_PREFIX_PATH|LD_LIBRARY_PATH|PYTHONPATH|PKG_CONFIG_PATH')
PORT = '11439'
LONGEST = 60.0  # seconds until the nodelet answers

# Publishes one detection over and over, by the messages of the installation.
TALKER = '''
import rospy
from rgbd_recognition.msg import Detection, DetectionArray
rospy.init_node('talker')
publisher = rospy.Publisher('/recognition/detections', DetectionArray, queue_size=1)
message = DetectionArray(detections=[Detection(object='tea', confidence=0.75)])
message.header.frame_id = 'camera'
message.detections[0].pose.pose.position.z = 0.5
while not rospy.is_shutdown():
    publisher.publish(message)
    rospy.sleep(0.2)
'''


def run(*command, **options):
    """What the command wrote; fails with it."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, **options)
    if done.returncode != 0:
        raise AssertionError('%s ended with %d:\n%s' % (' '.join(command), done.returncode, done.stdout))
    return done.stdout


def plain_environment():
    """This process's without all that a setup.bash puts there."""
    return {name: value for name, value in os.environ.items() if not ROS_VARIABLES.match(name)}


def prefix_of(build):
    with open(os.path.join(build, 'CMakeCache.txt')) as file:
        return re.search(r'^CMAKE_INSTALL_PREFIX:PATH=(.*)$', file.read(), re.MULTILINE).group(1)


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder_ = tempfile.TemporaryDirectory()
        cls.folder = cls.folder_.name
        # Not by --prefix: catkin's setup files would go to the prefix of the configuration all the same.
        run(CMAKE, '--install', os.environ['BUILD'], env=dict(os.environ, DESTDIR=cls.folder))
        cls.prefix = cls.folder + prefix_of(os.environ['BUILD'])

    @classmethod
    def tearDownClass(cls):
        cls.folder_.cleanup()

    def build_examples(self, environment, *arguments):
        build = os.path.join(self.folder, 'examples')
        told = run(CMAKE, '-S', os.path.join(PACKAGE, 'examples'), '-B', build, '-DCMAKE_PREFIX_PATH=' + self.prefix,
                   '-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror', '-DPYTHON_EXECUTABLE=' + sys.executable, *arguments,
                   env=environment)
        run(CMAKE, '--build', build, env=environment)
        return build, told

    def test_core_examples_need_no_ros(self):
        environment = plain_environment()
        build, told = self.build_examples(environment, '-DCMAKE_DISABLE_FIND_PACKAGE_catkin=ON')
        self.assertIn('no detection_listener', told)
        store = os.path.join(self.folder, 'store')
        told = run(os.path.join(build, 'train_from_mesh'), store, os.path.join(DEMO, 'models', 'obj_000003.ply'), 'sugar',
                   '0.001', env=environment)
        self.assertRegex(told, r'^\d+ points')
        scene = os.path.join(DEMO, 'test_primesense', '000001')
        told = run(os.path.join(build, 'recognize_picture'), store, os.path.join(scene, 'rgb', '000000.png'),
                   os.path.join(scene, 'depth', '000000.png'), os.path.join(scene, 'scene_camera.json'), env=environment)
        python = os.path.join(self.prefix, 'lib', 'python3', 'dist-packages')
        if glob.glob(os.path.join(python, 'rgbd_recognition', 'core.*')):
            run(sys.executable, '-c', 'from rgbd_recognition.core import Recognizer; print(Recognizer("%s").names)' % store,
                env=dict(environment, PYTHONPATH=python))
        found = re.match(r'sugar at +(\S+) +(\S+) +(\S+) m, confidence (\S+)\n$', told)
        self.assertTrue(found, told)
        for value, truth in zip(found.groups(), (0.126, 0.222, 0.990)):
            self.assertAlmostEqual(float(value), truth, delta=0.03)

    def test_nodelet_hears_detections(self):
        environment = dict(plain_environment(), ROS_MASTER_URI='http://localhost:' + PORT, ROS_HOME=self.folder)
        build, _ = self.build_examples(environment)
        setup = 'source %s/devel/setup.bash && exec ' % build
        started = []
        log = os.path.join(self.folder, 'listener.log')

        def start(command, output):
            started.append(subprocess.Popen(['bash', '-c', setup + command], env=environment, stdout=output, stderr=output))

        def heard():
            with open(log) as file:
                return file.read()

        try:
            with open(log, 'w') as output:
                start('roscore -p ' + PORT, subprocess.DEVNULL)
                start('rosrun nodelet nodelet standalone rgbd_recognition_examples/detection_listener', output)
                start("python3 -c '%s'" % TALKER.replace("'", '"'), output)
                deadline = time.time() + LONGEST
                while 'confidence' not in heard() and time.time() < deadline:
                    time.sleep(0.2)
        finally:
            for process in reversed(started):
                process.terminate()
            for process in started:
                process.wait()
        self.assertIn('tea at 0.000 0.000 0.500 m in camera, confidence 0.75', heard())


if __name__ == '__main__':
    unittest.main()
