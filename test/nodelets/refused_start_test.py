#!/usr/bin/env python3
"""A launch whose stages refuse to start ends, and says why by an absolute path."""
import os
import subprocess
import tempfile
import unittest

PORT = '11437'
LONGEST = 90.0  # seconds


def launch(*arguments):
    folder = tempfile.mkdtemp()
    environment = dict(os.environ, ROS_MASTER_URI='http://localhost:' + PORT, ROS_HOME=folder, PWD=folder)
    done = subprocess.run(['roslaunch', '-p', PORT, 'rgbd_recognition', *arguments], cwd=folder, env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=LONGEST)
    return folder, done.stdout


class RefusedStartTest(unittest.TestCase):
    def test_no_such_store(self):
        folder, told = launch('recognition.launch', 'models:=nowhere')
        self.assertIn('FATAL', told)
        self.assertIn(folder + '/nowhere', told)
        self.assertIn('refused to start', told)

    def test_a_store_that_cannot_be_made(self):
        folder, told = launch('training.launch', 'models:=/proc/nowhere', 'rviz:=false')
        self.assertIn('/proc/nowhere', told)
        self.assertIn('training refused to start', told)


if __name__ == '__main__':
    unittest.main()
