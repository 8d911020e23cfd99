#pragma once

#include <cstdint>
#include <vector>

#include "proposals/pose_proposer.h"

namespace recognition {

/// Ours, beyond the paper: poses of objects that show too little texture for a consensus set. One right correspondence
/// proposes a pose near the true one (see impliedRotations()), and the frame's depth and colours tell which of the
/// many proposals deserve a test: each is looked at (probeSurface()), the best of each object are drawn to the depth
/// and looked at again.
///
/// `active`: one a scene feature of the context, 1 where nothing explains it yet. At most `count`
/// hypotheses, the highest priority first, each with its one correspondence for a consensus set. Same result for any
/// number of threads.
std::vector<Hypothesis> proposeByCorrespondence(const ProposalContext& context, const std::vector<std::uint8_t>& active,
                                                int count);

}  // namespace recognition
