#pragma once

/// The package's messages as C++ types. They live in the namespace rgbd_recognition, the core's types of the same names
/// (Segmentation, SceneFeatures, Hypothesis, ...) in the namespace recognition.
#include <rgbd_recognition/Detect.h>
#include <rgbd_recognition/DetectionArray.h>
#include <rgbd_recognition/Feedback.h>
#include <rgbd_recognition/HypothesisArray.h>
#include <rgbd_recognition/SceneFeatures.h>
#include <rgbd_recognition/Segmentation.h>
#include <rgbd_recognition/StageTiming.h>
#include <rgbd_recognition/TrackArray.h>

namespace recognition {
namespace messages = ::rgbd_recognition;
}
