#pragma once

#include <vector>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/matching/hypothesis.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {

/// Throws std::invalid_argument that names the first hypothesis whose object or features do not exist, or whose pose is
/// no rigid motion.
void checkHypotheses(const std::vector<Hypothesis>& hypotheses, const PreparedModels& models, const SceneView& scene);

/// Likewise for matches.
void checkMatches(const SceneMatches& matches, const PreparedModels& models, const SceneView& scene);

}  // namespace recognition
