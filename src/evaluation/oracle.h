#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/frame_record.h"

namespace recognition {

/// The object's correspondences that agree with its true pose within 2 cm, the nearest descriptor of each scene feature.
std::vector<Correspondence> correctCorrespondences(const RecognitionResult& result, const ObjectModel& model,
                                                   int object, const Pose& camera_from_object);

/// The hypothesis that a perfect proposer would make of a true pose: a consensus set, if at least `min_consensus`
/// correspondences agree with it, else one correspondence, else shape alone.
Hypothesis trueHypothesis(const RecognitionResult& result, const ModelDatabase& database, int object,
                          const Pose& camera_from_object, int min_consensus);

/// Missed instances of one band, and what would have become of their true poses.
struct OracleCount {
  int instances = 0;  ///< all, found ones too
  int missed = 0;
  int proposed = 0;  ///< of the missed: a hypothesis near the true pose was tested
  int accepted = 0;  ///< of the missed: the true pose itself passes the test
};

struct OracleBand {
  std::string name;  ///< "visibility 30-50 %", "8-19 right correspondences", ...
  OracleCount count;
};

/// Bands by visibility, visible pixels, distance and right correspondences. Empty if no true pose was tested.
std::vector<OracleBand> oracleBands(const std::vector<FrameRecord>& records);

}  // namespace recognition
