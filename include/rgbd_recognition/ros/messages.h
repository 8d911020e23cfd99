#pragma once

/// The package's messages as C++ types. The generator puts them into the namespace of the package's name, where the
/// core's types of the same names (Segmentation, SceneFeatures, Hypothesis, ...) live; here they get a namespace of
/// their own. Include this, never the generated headers.
#define rgbd_recognition rgbd_recognition_messages
#include <rgbd_recognition/Detect.h>
#include <rgbd_recognition/DetectionArray.h>
#include <rgbd_recognition/Feedback.h>
#include <rgbd_recognition/HypothesisArray.h>
#include <rgbd_recognition/SceneFeatures.h>
#include <rgbd_recognition/Segmentation.h>
#include <rgbd_recognition/StageTiming.h>
#include <rgbd_recognition/TrackArray.h>
#undef rgbd_recognition

namespace rgbd_recognition {
namespace messages = ::rgbd_recognition_messages;
}
