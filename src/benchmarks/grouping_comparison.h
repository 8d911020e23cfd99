#pragma once

#include <nlohmann/json.hpp>

namespace recognition::benchmarks {

/// Algorithm 2, PCL's GeometricConsistencyGrouping and its Hough3DGrouping on the same synthetic correspondences (one
/// object of 0.2 m in a scene of 0.8 m, places with 2 mm of noise): milliseconds, right correspondences found, pose
/// error; for outlier ratios of 50 to 99 %. Hough3DGrouping and "algorithm2_oriented" are given rotations that are
/// right within 10 degrees for right correspondences.
nlohmann::json compareGrouping(int correspondences, int seed);

}  // namespace recognition::benchmarks
