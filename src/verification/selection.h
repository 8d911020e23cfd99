#pragma once

#include <vector>

#include "rgbd_recognition/model/object_model.h"
#include "verification/pose_verification.h"
#include "alignment/prepared_model.h"

namespace recognition {

/// The paper's choice: of hypotheses with the same best segment S* only the one with the highest total consistency
/// stays; the others get kConflict, or kDuplicate where it is the same object.
void selectBySegment(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses);

/// One region, one object: by falling gain, each takes the pixels that it explains; who has more than `max_overlap` of
/// its own pixels in common with better ones gets kConflict, or kDuplicate where it is the same object. Of two objects
/// that explain the same pixels about as well, the one comes first whose colours suit better where the two differ.
void selectByPixels(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses,
                    const SceneView& scene, double max_overlap);

}  // namespace recognition
