#!/usr/bin/env python3
"""evaluate_split.py MODELS SPLIT: how many objects of a BOP split are found within 2 cm, and how many finds are false."""
import sys

import numpy as np
from rgbd_recognition.core import Recognizer, read_bop_split

recognizer = Recognizer(sys.argv[1])
instances = found = false = 0
for frame in read_bop_split(sys.argv[2]):
    color, depth, camera = frame.load()  # numpy: uint8 rgb, float32 metres
    detections = recognizer.recognize(color, depth, camera).detections
    instances += len(frame.ground_truth)
    for detection in detections:
        offsets = [np.linalg.norm(truth.pose[:3, 3] - detection.pose[:3, 3])
                   for truth in frame.ground_truth if truth.object_id == detection.object_id]
        right = min(offsets, default=np.inf) < 0.02
        found, false = found + right, false + (not right)
print('%d of %d found, %d false' % (found, instances, false))
