#pragma once

#include <vector>

#include "rgbd_recognition/core/pose.h"

namespace recognition {

/// An instance of an object, detected or true.
struct ScoredInstance {
  int object_id = 0;
  Pose camera_from_object = Pose::Identity();
};

/// A detection that found an instance.
struct Hit {
  int detection = -1;              ///< index
  int truth = -1;                  ///< index
  double translation_error = 0.0;  ///< metres
  double rotation_error = 0.0;     ///< degrees
  double accuracy = 0.0;           ///< 0.5 s_r + 0.5 s_t
};

/// One frame of the ICRA'11 Solutions in Perception Challenge, scored.
struct FrameScore {
  std::vector<Hit> hits;
  std::vector<int> missed;           ///< indices of ground truth
  std::vector<int> false_positives;  ///< indices of detections
  double score = 0.0;                ///< in instances
};

/// 1 up to 1 cm, 0 from 3 cm, linear between (metres).
double translationScore(double error);
/// 1 up to 2 degrees, 0 from 20, linear between (degrees).
double rotationScore(double error);

/// The challenge's rule: a detection hits an instance of the same object (closest pairs first where there are several),
/// and score = 0.5 max(0, hits - 0.5 misses - false_positives + sum of accuracies).
FrameScore scoreFrame(const std::vector<ScoredInstance>& detections, const std::vector<ScoredInstance>& truth);

}  // namespace recognition
