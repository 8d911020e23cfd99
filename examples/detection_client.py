#!/usr/bin/env python3
"""Asks the action detect for objects, tells where the frame is meanwhile: detection_client.py [OBJECT]..."""
import sys

import actionlib
import rospy
from rgbd_recognition.msg import DetectAction, DetectGoal

rospy.init_node('detection_client')
client = actionlib.SimpleActionClient('/recognition/detect', DetectAction)
if not client.wait_for_server(rospy.Duration(10)):
    sys.exit('/recognition/detect does not answer: is recognition.launch running?')
client.send_goal(DetectGoal(objects=sys.argv[1:], timeout=30),
                 feedback_cb=lambda told: print('%.1f s: %s' % (told.seconds, told.stage)))
client.wait_for_result()  # client.cancel_goal() from another thread would end the wait
result = client.get_result()
for found in result.result.detections:
    place = found.pose.pose.position
    print('%s %.2f at %.3f %.3f %.3f' % (found.object, found.confidence, place.x, place.y, place.z))
if not result.success:
    sys.exit(result.message)
