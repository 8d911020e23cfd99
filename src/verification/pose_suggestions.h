#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_recognition/matching/correspondence_search.h"
#include "rgbd_recognition/verification/prepared_model.h"
#include "rgbd_recognition/verification/scene_view.h"

namespace rgbd_recognition {

/// Ours, beyond the paper: poses of objects that show too little print for a consensus set. One right correspondence
/// suggests a pose near the true one (see suggestedRotations()), and the frame's depth and colours tell which of the
/// many suggestions deserve a test: each is looked at (probeSurface()), the best of each object are drawn to the depth
/// and looked at again.
///
/// `matches` of all objects; `active`: one a scene feature, 1 where nothing explains it yet. At most `count`
/// hypotheses, the most promising first, each with its one correspondence for a consensus set. Same result for any
/// number of threads.
std::vector<Hypothesis> suggestPoses(const SceneMatches& matches, const std::vector<std::uint8_t>& active,
                                     const PreparedModels& models, const SceneView& scene, int count);

}  // namespace rgbd_recognition
