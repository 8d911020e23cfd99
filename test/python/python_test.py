#!/usr/bin/env python3
"""The Python module, without ROS: models, recognition, evaluation. STORE names a store of the demo's models."""
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from rgbd_recognition.core import Camera, ModelStore, Recognizer, Trainer, evaluate_frame, read_bop_split, report

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEMO = os.path.join(PACKAGE, 'test', 'data', 'demo')
SPLIT = os.path.join(DEMO, 'test_primesense')
STORE = os.environ['STORE']


class PythonTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recognizer = Recognizer(STORE)
        cls.frame = read_bop_split(SPLIT)[0]
        cls.color, cls.depth, cls.camera = cls.frame.load()

    def found(self, *arguments, **options):
        return {d.object: d for d in self.recognizer.recognize(*arguments, **options).detections}

    def test_finds_what_is_there(self):
        found = {d.object_id: d for d in self.found(self.color, self.depth, self.camera).values()}
        truth = {t.object_id: t.pose for t in self.frame.ground_truth}
        self.assertEqual(set(found), {1, 2, 3})
        for number, detection in found.items():
            self.assertLess(np.linalg.norm(detection.pose[:3, 3] - truth[number][:3, 3]), 0.02)
            self.assertEqual(detection.pose.shape, (4, 4))
            self.assertEqual(detection.covariance.shape, (6, 6))
            self.assertTrue(detection.accepted and detection.confidence > 0.5)

    def test_same_answer_to_the_same_frame_in_other_forms(self):
        expected = self.found(self.color, self.depth, self.camera)
        wide = np.zeros((480, 700, 3), np.uint8)
        wide[:, 20:660] = self.color[:, :, ::-1]
        apart = wide[:, 20:660]  # rows are apart, and it cannot be written to
        apart.flags.writeable = False
        camera = Camera(self.camera.fx, self.camera.fy, self.camera.cx, self.camera.cy)
        answer = self.found(apart, self.depth, camera, order='bgr')
        self.assertEqual(set(answer), set(expected))
        for name in expected:
            np.testing.assert_array_equal(answer[name].pose, expected[name].pose)

    def test_millimetres_in_16_bits(self):
        millimetres = np.round(1000 * np.nan_to_num(self.depth)).astype(np.uint16)
        self.assertEqual(set(self.found(self.color, millimetres, self.camera)),
                         set(self.found(self.color, self.depth, self.camera)))

    def test_results_are_numpy_over_the_librarys_memory(self):
        result = self.recognizer.recognize(self.color, self.depth, self.camera)
        labels = result.labels
        self.assertEqual((labels.dtype, labels.shape, labels.flags.owndata), (np.int32, (480, 640), False))
        del result
        self.assertGreater(labels.max(), 1)  # it outlives the result
        self.assertFalse(self.color.flags.owndata)

    def test_bad_images_are_told(self):
        for color, depth, words in ((self.color.astype(np.float64), self.depth, 'uint8'),
                                    (self.color[:, ::2], self.depth, 'side by side'),
                                    (self.color[0, 0], self.depth, 'dimensions'),
                                    (self.color, self.depth[:100, :100], 'depth')):
            with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
                self.recognizer.recognize(color, depth, self.camera)
        with self.assertRaisesRegex(ValueError, 'order'):
            self.recognizer.recognize(self.color, self.depth, self.camera, order='hsv')
        with self.assertRaisesRegex(RuntimeError, 'nowhere'):
            Recognizer('/nowhere')

    def test_models(self):
        store = ModelStore(STORE)
        self.assertIn('003_cracker_box', store.names())
        model = store.load('003_cracker_box')
        self.assertEqual(model.points.shape, model.colors.shape)
        np.testing.assert_allclose(np.linalg.norm(model.normals, axis=1), 1, atol=1e-3)
        self.assertEqual(model.descriptors('surf64').shape[1], 64)
        with self.assertRaises(KeyError):
            model.descriptors('sift')

    def test_trains_what_it_then_finds(self):
        with tempfile.TemporaryDirectory() as folder:
            model = Trainer(folder, ['surf64']).train_from_mesh(os.path.join(DEMO, 'models', 'obj_000003.ply'), 'sugar',
                                                                unit=0.001)
            self.assertIn('surf64', repr(model))
            detections = Recognizer(folder).recognize(self.color, self.depth, self.camera).detections
            self.assertEqual([d.object for d in detections], ['sugar'])

    def test_evaluates(self):
        record = evaluate_frame(self.recognizer, self.frame)
        self.assertGreater(record.score, 2)
        self.assertRegex(report([record]), r'instances 3: found 3, missed 0, false 0')

    def test_the_example(self):
        done = subprocess.run([sys.executable, os.path.join(PACKAGE, 'examples', 'evaluate_split.py'), STORE, SPLIT],
                              stdout=subprocess.PIPE, universal_newlines=True, check=True)
        self.assertRegex(done.stdout, r'^9 of \d+ found, 0 false\n$')


if __name__ == '__main__':
    unittest.main()
