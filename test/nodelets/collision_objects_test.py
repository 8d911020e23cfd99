#!/usr/bin/env python3
"""Detections become collision objects; without MoveIt's messages the script says what is missing."""
import importlib.util
import os
import subprocess
import sys
import types
import unittest

from geometry_msgs.msg import Pose
from rgbd_recognition.msg import Detection, DetectionArray

SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), 'scripts',
                      'collision_objects.py')


class CollisionObject:
    """The fields that are used of moveit_msgs/CollisionObject."""
    ADD, REMOVE = 0, 1

    def __init__(self):
        self.header = self.operation = None
        self.id = ''
        self.type = types.SimpleNamespace(key='')
        self.primitives, self.primitive_poses = [], []


class SolidPrimitive:
    BOX = 1

    def __init__(self):
        self.type, self.dimensions = 0, []


def script():
    spec = importlib.util.spec_from_file_location('collision_objects', SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def box(name, instance=0, accepted=True, confidence=0.9):
    detection = Detection(object=name, instance=instance, accepted=accepted, confidence=confidence,
                          frame='left/%s_%d' % (name, instance), box=Pose())
    detection.box.position.z = 1.0
    detection.size.x, detection.size.y, detection.size.z = 0.1, 0.2, 0.3
    return detection


def seen(*detections):
    array = DetectionArray(detections=list(detections))
    array.header.frame_id = 'base_link'
    return array


class CollisionObjectsTest(unittest.TestCase):
    def setUp(self):
        self.scene = script().Scene(CollisionObject, SolidPrimitive, keep=10.0, margin=0.01)

    def test_boxes_are_added(self):
        changes = self.scene.update(
            seen(box('tea'), box('tea', 1), box('cup', accepted=False), box('pot', confidence=0.1)), 0.0)
        self.assertEqual([change.id for change in changes], ['left_tea_0', 'left_tea_1'])
        change = changes[0]
        self.assertEqual(change.operation, CollisionObject.ADD)
        self.assertEqual(change.header.frame_id, 'base_link')
        self.assertEqual(change.primitives[0].type, SolidPrimitive.BOX)
        for length, wanted in zip(change.primitives[0].dimensions, (0.12, 0.22, 0.32)):
            self.assertAlmostEqual(length, wanted)
        self.assertEqual(change.primitive_poses[0].position.z, 1.0)

    def test_what_is_gone_is_removed_later(self):
        self.scene.update(seen(box('tea')), 0.0)
        self.assertEqual(self.scene.update(seen(), 9.0), [])
        changes = self.scene.update(seen(), 11.0)
        self.assertEqual([(change.id, change.operation) for change in changes],
                         [('left_tea_0', CollisionObject.REMOVE)])
        self.assertEqual(self.scene.update(seen(), 30.0), [])

    @unittest.skipIf(importlib.util.find_spec('moveit_msgs'), 'MoveIt is there')
    def test_without_moveit_it_says_what_is_missing(self):
        done = subprocess.run([sys.executable, SCRIPT], stderr=subprocess.PIPE, universal_newlines=True, timeout=30)
        self.assertEqual(done.returncode, 1)
        self.assertIn('moveit_msgs', done.stderr)
        self.assertIn('install MoveIt', done.stderr)


if __name__ == '__main__':
    unittest.main()
