#!/usr/bin/env python3
"""The aggregated diagnostics say which stage is missing."""
import os
import signal
import sys
import threading
import unittest
import xmlrpc.client

import rosgraph
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

STAGES = {'Segmentation', 'Feature extraction', 'Hypothesis generation', 'Reprojection verification'}
PATIENCE = 90.0  # seconds


class Present:
    """The stages of which /diagnostics_agg has fresh news."""

    def __init__(self):
        self.changed = threading.Condition()
        self.stages = set()
        rospy.Subscriber('/diagnostics_agg', DiagnosticArray, self.receive, queue_size=1)

    def receive(self, message):
        statuses = {status.name.split('/')[-1]: status for status in message.status}
        with self.changed:
            self.stages = {stage for stage in STAGES & set(statuses)
                           if statuses[stage].level != DiagnosticStatus.STALE and 'Missing' not in
                           statuses[stage].message}
            self.changed.notify_all()

    def become(self, stages):
        with self.changed:
            self.changed.wait_for(lambda: self.stages == stages, PATIENCE)
            return self.stages


class MissingStageTest(unittest.TestCase):
    def test_it_is_told_which(self):
        present = Present()
        self.assertEqual(present.become(STAGES), STAGES)
        name = rospy.get_name()
        loader = xmlrpc.client.ServerProxy(rosgraph.Master(name).lookupNode('/recognition/feature_extraction'))
        os.kill(loader.getPid(name)[2], signal.SIGINT)  # it unloads its nodelet
        others = STAGES - {'Feature extraction'}
        self.assertEqual(present.become(others), others)


if __name__ == '__main__':
    rospy.init_node('missing_stage_test')
    rostest.rosrun('rgbd_recognition', 'missing_stage', MissingStageTest, sys.argv)
