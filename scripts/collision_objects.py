#!/usr/bin/env python3
"""Detections as collision objects of MoveIt: boxes.

Needs moveit_msgs. Listens to `detections` (rosrun rgbd_recognition collision_objects __ns:=/recognition), publishes
/collision_object. Parameters: ~keep (s; 30), how long an object stays that is no longer seen, 0 for ever; ~margin (m;
0), added to each side of a box; ~min_confidence (0.5).
"""
import sys

import rospy
from rgbd_recognition.msg import DetectionArray


def imports():
    """Messages that not every machine has: (CollisionObject, SolidPrimitive), or None with a line that says what is
    missing."""
    try:
        from moveit_msgs.msg import CollisionObject
        from shape_msgs.msg import SolidPrimitive
    except ImportError as error:
        print('%s: install MoveIt (ros-noetic-moveit-msgs), which has the messages of collision objects' % error,
              file=sys.stderr)
        return None
    return CollisionObject, SolidPrimitive


def identifier(detection):
    """As its tf frame, but without slashes, which MoveIt keeps for subframes."""
    return (detection.frame or '%s_%d' % (detection.object, detection.instance)).replace('/', '_')


class Scene:
    """What is in the planning scene, and what has to change in it."""

    def __init__(self, collision_object, solid_primitive, keep=30.0, margin=0.0, min_confidence=0.5):
        self.collision_object = collision_object
        self.solid_primitive = solid_primitive
        self.keep, self.margin, self.min_confidence = keep, margin, min_confidence
        self.seen = {}  # time by identifier

    def update(self, detections, now):
        """Collision objects to publish for a DetectionArray that came at `now`, seconds."""
        changes = []
        for detection in detections.detections:
            if detection.accepted and detection.confidence >= self.min_confidence:
                self.seen[identifier(detection)] = now
                changes.append(self.added(detection, detections.header))
        if self.keep > 0.0:
            for name in [name for name, time in self.seen.items() if now - time > self.keep]:
                del self.seen[name]
                changes.append(self.removed(name, detections.header))
        return changes

    def added(self, detection, header):
        box = self.solid_primitive()
        box.type = self.solid_primitive.BOX
        size = detection.size
        box.dimensions = [length + 2.0 * self.margin for length in (size.x, size.y, size.z)]
        change = self.collision_object()
        change.header = header
        change.id = identifier(detection)
        change.type.key = detection.object
        change.primitives = [box]
        change.primitive_poses = [detection.box]
        change.operation = self.collision_object.ADD
        return change

    def removed(self, name, header):
        change = self.collision_object()
        change.header = header
        change.id = name
        change.operation = self.collision_object.REMOVE
        return change


def main():
    types = imports()
    if types is None:
        return 1
    rospy.init_node('collision_objects')
    scene = Scene(*types, keep=rospy.get_param('~keep', 30.0), margin=rospy.get_param('~margin', 0.0),
                  min_confidence=rospy.get_param('~min_confidence', 0.5))
    publisher = rospy.Publisher('/collision_object', types[0], queue_size=50)

    def receive(detections):
        for change in scene.update(detections, rospy.get_time()):
            publisher.publish(change)

    rospy.Subscriber('detections', DetectionArray, receive, queue_size=1)
    rospy.spin()
    return 0


if __name__ == '__main__':
    sys.exit(main())
