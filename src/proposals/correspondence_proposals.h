#pragma once

#include <cstdint>
#include <vector>

#include "matching/correspondence_search.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {

/// Ours, beyond the paper: poses of objects that show too little texture for a consensus set. One right correspondence
/// proposes a pose near the true one (see impliedRotations()), and the frame's depth and colours tell which of the
/// many proposals deserve a test: each is looked at (probeSurface()), the best of each object are drawn to the depth
/// and looked at again.
///
/// `matches` of all objects; `active`: one a scene feature, 1 where nothing explains it yet. At most `count`
/// hypotheses, the highest priority first, each with its one correspondence for a consensus set. Same result for any
/// number of threads.
std::vector<Hypothesis> proposeByCorrespondence(const SceneMatches& matches, const std::vector<std::uint8_t>& active,
                                                const PreparedModels& models, const SceneView& scene, int count);

}  // namespace recognition
