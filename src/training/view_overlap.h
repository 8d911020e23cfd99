#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace recognition {

/// What a turn around an object lacks, in words: how many views more, and between which angles around z. Empty where
/// each view overlaps with its neighbours. `directions` lead from the object to the cameras.
std::string missingViews(const std::vector<Eigen::Vector3f>& directions);

}  // namespace recognition
