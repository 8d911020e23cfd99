#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// How FindFeatureCorrespondences looks for pairs.
enum class SearchMode {
  kExhaustive,  ///< the paper's: each model feature with its nearest scene feature, no ratio test
  kIndex        ///< each scene feature with its nearest features over all models, from one index
};

/// Which correspondences Algorithm 2 fixes first: the order of T_f.
enum class CorrespondenceOrder {
  kDistance,  ///< the paper's: small distance of the descriptors first
  kSupport    ///< ours: those first that many others agree with on the pose, see poseSupport()
};

/// Parameters of Sec. V's matching (Table III and ours). Defaults are ours; config/paper.yaml holds the paper's.
struct MatchingParameters {
  SearchMode search = SearchMode::kIndex;
  double delta_f = 1.0;          ///< Delta_f of Table III
  int neighbors = 8;             ///< index mode: nearest model features a scene feature may take
  int neighbors_per_object = 3;  ///< index mode: of these, at most so many of one object
  double neighbor_ratio = 1.5;   ///< index mode: none farther than this times the nearest
  double size_tolerance = 2.0;   ///< ours: largest ratio of the metric sizes of a pair's features
  CorrespondenceOrder order = CorrespondenceOrder::kSupport;
  double support_radius = 0.05;    ///< order support: of places of the object's centre that agree, metres
  int min_support = 3;             ///< order support: correspondences with fewer that agree are dropped
  double alpha = 0.05;             ///< alpha of Algorithm 2, as a fraction
  double beta = 1.0;               ///< beta of Algorithm 2, as a fraction
  int min_filtered = 20;           ///< ours: the filters alpha and beta keep at least so many
  double epsilon_g = 0.012;        ///< tolerance of eq. (8)
  double delta_d = 0.015;          ///< Delta_d of eq. (9) and Table III
  int ransac_iterations = 100;     ///< n_r of Table III
  bool skip_explained = true;      ///< ours: correspondences of the largest consensus are not fixed first again
  bool grow_consensus = true;      ///< ours: the final consensus comes from all correspondences, not from T_3 only
  double max_rotation = 50.0;      ///< ours: between the rotations that two correspondences propose
  double max_view_angle = 75.0;    ///< ours: between a feature's trained view direction and the camera
  int min_consensus = 5;           ///< smaller consensus sets make no hypothesis
  double min_spread = 0.006;       ///< ours: second-largest deviation of a consensus set, guards against collinear ones
  int hypotheses_per_object = 24;  ///< ours: several instances, or several poses of one
  double alternative_ratio = 0.6;  ///< ours: consensus of a second pose over the same features, against the first's
  double work_limit_ms =
      2000.0;  ///< safety limit of Algorithm 2 a round, all objects; counted in work, not by the clock
  int seed = 1;

  ParameterList list();
  void validate() const;
};

/// Limits of matching that later stages share.
struct MatchingLimits {
  double delta_d = MatchingParameters().delta_d;                ///< metres, eq. (9)
  double size_tolerance = MatchingParameters().size_tolerance;  ///< ratio of metric sizes
  double max_view_angle = MatchingParameters().max_view_angle;  ///< degrees
  double support_radius = MatchingParameters().support_radius;  ///< metres
  double max_rotation = MatchingParameters().max_rotation;      ///< degrees

  MatchingLimits() = default;
  explicit MatchingLimits(const MatchingParameters& p)
      : delta_d(p.delta_d),
        size_tolerance(p.size_tolerance),
        max_view_angle(p.max_view_angle),
        support_radius(p.support_radius),
        max_rotation(p.max_rotation) {}
};

}  // namespace recognition
