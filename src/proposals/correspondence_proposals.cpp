#include "proposals/correspondence_proposals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/core/utility.hpp>

#include "matching/geometric_consistency.h"
#include "matching/pose_support.h"
#include "alignment/surface_probe.h"
#include "proposals/proposal_ranking.h"

namespace recognition {
namespace {

constexpr ProbeLimits kCorrespondenceLimits = {0.15, 0.6};
constexpr size_t kRefinedCorrespondences = 6;
constexpr size_t kRefined = 64;          // all objects
constexpr size_t kProbedPerObject = 60;  // those of the smallest descriptor distance
constexpr float kNearBest = 1.05f;       // of the distance of the feature's nearest neighbour over all objects

/// Proposals of one object's correspondences that the frame does not contradict.
class ObjectProposals {
 public:
  ObjectProposals(int object, const ProposalContext& context, const std::vector<Eigen::Quaternionf>& scene_frames)
      : object_(object),
        model_(context.models.at(object)),
        scene_(context.scene),
        limits_(context.limits),
        scene_frames_(scene_frames) {
    const ObjectModel& trained = context.models.object(object);
    const auto features = trained.features.find(scene_.features->image.type);
    if (features != trained.features.end()) features_ = &features->second;
  }

  /// `nearest`: of each scene feature, distance of its nearest neighbour over all objects; matches of features that
  /// resemble another object more are left out, as are all but the nearest ones.
  std::vector<Proposal> find(const std::vector<Correspondence>& matches, const std::vector<std::uint8_t>& active,
                             const std::vector<float>& nearest) const {
    std::vector<Correspondence> pairs;
    for (const Correspondence& pair : matches) {  // by falling likeness
      const auto feature = static_cast<size_t>(pair.scene_feature);
      if (pairs.size() == kProbedPerObject) break;
      if (active[feature] != 0 && pair.distance <= kNearBest * nearest[feature]) pairs.push_back(pair);
    }
    if (!features_ || pairs.empty()) return {};
    const auto rotations =
        impliedRotations(pairs, scene_frames_, model_.feature_frames.at(scene_.features->image.type));
    if (rotations.empty()) return {};
    std::vector<Proposal> found;
    std::vector<Correspondence> found_pairs;
    std::vector<Eigen::Quaternionf> found_rotations;
    for (size_t i = 0; i < pairs.size(); ++i) {
      const Proposal one = lookAt(pairs[i], rotations[i]);
      if (!kCorrespondenceLimits.hold(one.probe)) continue;
      found.push_back(one);
      found_pairs.push_back(pairs[i]);
      found_rotations.push_back(rotations[i]);
    }
    const auto support = poseSupport(found_pairs, found_rotations, scene_.features->points, features_->positions,
                                     limits_.support_radius, limits_.max_rotation);
    for (size_t i = 0; i < found.size(); ++i) {
      found[i].support = std::log1p(support[i]);
      found[i].rate(false);
    }
    keepDistinct(model_, kRefinedCorrespondences, &found);
    return found;
  }

 private:
  Proposal lookAt(const Correspondence& pair, const Eigen::Quaternionf& rotation) const {
    Proposal one;
    one.object = object_;
    one.pair = pair;
    one.camera_from_object.linear() = rotation.cast<double>().toRotationMatrix();
    const Eigen::Vector3d seen = scene_.features->points[static_cast<size_t>(pair.scene_feature)].cast<double>();
    const Eigen::Vector3d own = features_->positions[static_cast<size_t>(pair.model_feature)].cast<double>();
    one.camera_from_object.translation() = seen - one.camera_from_object.linear() * own;
    one.probe = probeSurface(model_, kFirstProbe, one.camera_from_object, scene_, kCorrespondenceLimits);
    if (!kCorrespondenceLimits.hold(one.probe)) return one;
    one.camera_from_object = alignToDepth(model_, kAlignmentPoints, one.camera_from_object, scene_);
    one.probe = probeSurface(model_, kFirstProbe, one.camera_from_object, scene_);
    return one;
  }

  int object_;
  const PreparedModel& model_;
  const SceneView& scene_;
  const MatchingLimits& limits_;
  const std::vector<Eigen::Quaternionf>& scene_frames_;
  const ModelFeatures* features_ = nullptr;
};

}  // namespace

std::vector<Hypothesis> proposeByCorrespondence(const ProposalContext& context, const std::vector<std::uint8_t>& active,
                                                int count) {
  const SceneView& scene = context.scene;
  const SceneMatches& matches = context.matches;
  std::vector<std::vector<Proposal>> by_object(matches.by_object.size());
  const std::vector<Eigen::Quaternionf> frames = featureFrames(*scene.features);
  std::vector<float> nearest(scene.features->points.size(), std::numeric_limits<float>::max());
  for (const auto& pairs : matches.by_object)
    for (const Correspondence& pair : pairs) {
      float& best = nearest[static_cast<size_t>(pair.scene_feature)];
      best = std::min(best, pair.distance);
    }
  const cv::Range all(0, static_cast<int>(by_object.size()));
  cv::parallel_for_(
      all,
      [&](const cv::Range& range) {
        for (int object = range.start; object < range.end; ++object)
          by_object[static_cast<size_t>(object)] =
              ObjectProposals(object, context, frames)
                  .find(matches.by_object[static_cast<size_t>(object)], active, nearest);
      },
      all.size());
  ProposalLimits limits;
  limits.tested = static_cast<size_t>(count);
  limits.refined = kRefined;
  return hypothesesOf(std::move(by_object), context.models, scene, limits);
}

}  // namespace recognition
