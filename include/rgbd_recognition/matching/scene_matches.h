#pragma once

#include <vector>

#include "rgbd_recognition/matching/hypothesis.h"

namespace recognition {

/// Correspondences of one frame with all objects, found once and used by every round.
struct SceneMatches {
  std::vector<std::vector<Correspondence>> by_object;  ///< index as in ModelDatabase::objects; sorted by distance (T_f)
};

/// What the generation left out or spent, for diagnostics. Adds up over rounds.
struct GenerationReport {
  bool budget_exhausted = false;
  std::vector<int> objects_cut_short;  ///< indices of objects whose search was stopped by the budget
  double work_ms = 0.0;                ///< work of Algorithm 2, in the unit of MatchingParameters::work_limit_ms
};

}  // namespace recognition
