#include "rgbd_recognition/matching/matching_parameters.h"

namespace recognition {

ParameterList MatchingParameters::list() {
  return {
      choiceParameter("search", &search, {"exhaustive", "index"},
                      "exhaustive: each model feature's nearest scene feature (the paper); index: each scene feature's "
                      "nearest features over all models"),
      doubleParameter("delta_f", "", &delta_f, 0.0, 2.0, "Delta_f: pairs of descriptors must be nearer than this"),
      intParameter("neighbors", "", &neighbors, 1, 256, "index: nearest model features a scene feature may take"),
      intParameter("neighbors_per_object", "", &neighbors_per_object, 1, 64,
                   "index: of these, at most so many of an object"),
      doubleParameter("neighbor_ratio", "", &neighbor_ratio, 1.0, 100.0,
                      "index: no neighbour farther than this times the nearest"),
      doubleParameter("size_tolerance", "", &size_tolerance, 1.0, 1000.0,
                      "largest ratio of the metric sizes of a pair's features; 1000 turns the test off"),
      choiceParameter("order", &order, {"distance", "support"},
                      "of the correspondences in Algorithm 2's loops; distance: of descriptors (the paper); support: "
                      "how many others agree on the pose"),
      doubleParameter("support_radius", "m", &support_radius, 0.001, 1.0,
                      "order support: places of the object's centre this near agree"),
      intParameter("min_support", "", &min_support, 0, 1000,
                   "order support: correspondences with fewer that agree are dropped"),
      doubleParameter("alpha", "", &alpha, 0.0, 1.0, "share of the correspondences in Algorithm 2's outer loop"),
      doubleParameter("beta", "", &beta, 0.0, 1.0, "share of the consistent ones in Algorithm 2's inner loop"),
      intParameter("min_filtered", "", &min_filtered, 0, 1000, "alpha and beta keep at least so many correspondences"),
      doubleParameter("epsilon_g", "m", &epsilon_g, 0.0001, 0.1, "tolerance of the equal distances of eq. 8"),
      doubleParameter("delta_d", "m", &delta_d, 0.0001, 0.1, "Delta_d: tolerance of the consensus, eq. 9"),
      intParameter("ransac_iterations", "", &ransac_iterations, 1, 10000, "n_r: most RANSAC iterations on one set T_3"),
      boolParameter("skip_explained", &skip_explained, "do not fix a correspondence of the largest consensus again"),
      boolParameter("grow_consensus", &grow_consensus, "collect the final consensus from all correspondences"),
      doubleParameter(
          "max_rotation", "deg", &max_rotation, 0.0, 180.0,
          "between the rotations that two correspondences propose by their features' orientations; 180 turns "
          "the test off"),
      doubleParameter("max_view_angle", "deg", &max_view_angle, 0.0, 180.0,
                      "between a feature's trained view direction and the camera; 180 turns the test off"),
      intParameter("min_consensus", "", &min_consensus, 3, 1000, "smaller consensus sets make no hypothesis"),
      doubleParameter("min_spread", "m", &min_spread, 0.0, 0.1,
                      "second-largest standard deviation of a consensus set's points; smaller is too near to a line"),
      intParameter("hypotheses_per_object", "", &hypotheses_per_object, 1, 100,
                   "most hypotheses of an object in a round"),
      doubleParameter("alternative_ratio", "", &alternative_ratio, 0.0, 1.0,
                      "a second pose over the same features needs this share of the first one's consensus"),
      doubleParameter("work_limit_ms", "ms", &work_limit_ms, 1.0, 60000.0,
                      "safety limit: work of Algorithm 2 in a round over all objects, in milliseconds of one core of "
                      "2.5 GHz; counted, not timed"),
      intParameter("seed", "", &seed, 0, 2147483647, "of the random samples"),
  };
}

void MatchingParameters::validate() const {
  MatchingParameters copy = *this;
  validateParameters(copy.list(), "hypothesis_generation");
}

}  // namespace recognition
