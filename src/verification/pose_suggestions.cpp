#include "pose_suggestions.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <opencv2/core/utility.hpp>

#include "rgbd_recognition/matching/consistency.h"
#include "rgbd_recognition/matching/pose_support.h"
#include "rgbd_recognition/verification/pose_refiner.h"
#include "rgbd_recognition/verification/surface_probe.h"

namespace rgbd_recognition {
namespace {

constexpr int kFirstProbe = 120, kSecondProbe = 400, kSettled = 120;  // points
constexpr double kLeastAgreeing = 0.15, kMostFreeSpace = 0.6;
constexpr double kSupportRadius = 0.05, kSupportRotation = 50.0;   // metres, degrees
constexpr double kSameDistance = 0.015, kSameRotation = 15.0;      // metres, degrees
constexpr size_t kRefinedPerObject = 24, kRefinedPerFrame = 400, kTestedPerObject = 4;
constexpr int kRefineIterations = 5, kRefineSamples = 120;
// Fitted on simulated scenes, to what becomes a right pose.
constexpr double kCorrelationFirst = 4.0, kCorrelationRefined = 7.0, kSupportWeight = 1.5, kFreeSpaceWeight = 2.0;

struct Suggestion {
  int object = -1;
  Correspondence pair;
  Pose camera_from_object = Pose::Identity();
  ProbeResult probe;
  double support = 0.0;  ///< logarithm
  double promise = 0.0;  ///< the larger, the sooner tested

  void rate(double correlation_weight) {
    promise = probe.agreeing - kFreeSpaceWeight * probe.free_space + correlation_weight * probe.correlation +
              kSupportWeight * support;
  }
};

bool samePose(const Suggestion& a, const Suggestion& b, const Eigen::Vector3d& centre) {
  if ((a.camera_from_object * centre - b.camera_from_object * centre).norm() > kSameDistance) return false;
  const double trace = (a.camera_from_object.linear().transpose() * b.camera_from_object.linear()).trace();
  return trace > 1.0 + 2.0 * std::cos(kSameRotation * 3.14159265358979323846 / 180.0);
}

/// Sorts by falling promise and keeps the first `count`.
void keepPromising(size_t count, std::vector<Suggestion>* suggestions) {
  std::stable_sort(suggestions->begin(), suggestions->end(),
                   [](const Suggestion& a, const Suggestion& b) { return a.promise > b.promise; });
  if (suggestions->size() > count) suggestions->resize(count);
}

/// The same with those only that differ from one another.
void keepBest(const PreparedModel& model, size_t count, std::vector<Suggestion>* suggestions) {
  keepPromising(suggestions->size(), suggestions);
  std::vector<Suggestion> kept;
  for (const Suggestion& one : *suggestions) {
    if (kept.size() == count) break;
    const auto same = [&](const Suggestion& other) { return samePose(one, other, model.centre.cast<double>()); };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(one);
  }
  *suggestions = std::move(kept);
}

/// Suggestions of one object's correspondences that the frame does not contradict.
class ObjectSuggestions {
 public:
  ObjectSuggestions(int object, const PreparedModels& models, const SceneView& scene,
                    const std::vector<Eigen::Quaternionf>& scene_frames)
      : object_(object), model_(models.at(object)), scene_(scene), scene_frames_(scene_frames) {
    const auto features = models.object(object).features.find(scene.features->image.type);
    if (features != models.object(object).features.end()) features_ = &features->second;
  }

  std::vector<Suggestion> find(const std::vector<Correspondence>& matches,
                               const std::vector<std::uint8_t>& active) const {
    std::vector<Correspondence> pairs;
    std::copy_if(matches.begin(), matches.end(), std::back_inserter(pairs),
                 [&](const Correspondence& pair) { return active[static_cast<size_t>(pair.scene_feature)] != 0; });
    if (!features_ || pairs.empty()) return {};
    const auto rotations =
        suggestedRotations(pairs, scene_frames_, model_.feature_frames.at(scene_.features->image.type));
    if (rotations.empty()) return {};
    std::vector<Suggestion> found;
    std::vector<Correspondence> found_pairs;
    std::vector<Eigen::Quaternionf> found_rotations;
    for (size_t i = 0; i < pairs.size(); ++i) {
      const Suggestion one = lookAt(pairs[i], rotations[i]);
      if (one.probe.agreeing < kLeastAgreeing || one.probe.free_space > kMostFreeSpace) continue;
      found.push_back(one);
      found_pairs.push_back(pairs[i]);
      found_rotations.push_back(rotations[i]);
    }
    const auto support = poseSupport(found_pairs, found_rotations, scene_.features->points, features_->positions,
                                     kSupportRadius, kSupportRotation);
    for (size_t i = 0; i < found.size(); ++i) {
      found[i].support = std::log1p(support[i]);
      found[i].rate(kCorrelationFirst);
    }
    keepBest(model_, kRefinedPerObject, &found);
    return found;
  }

 private:
  Suggestion lookAt(const Correspondence& pair, const Eigen::Quaternionf& rotation) const {
    Suggestion one;
    one.object = object_;
    one.pair = pair;
    one.camera_from_object.linear() = rotation.cast<double>().toRotationMatrix();
    const Eigen::Vector3d seen = scene_.features->points[static_cast<size_t>(pair.scene_feature)].cast<double>();
    const Eigen::Vector3d own = features_->positions[static_cast<size_t>(pair.model_feature)].cast<double>();
    one.camera_from_object.translation() = seen - one.camera_from_object.linear() * own;
    one.probe = probeSurface(model_, kFirstProbe, one.camera_from_object, scene_);
    if (one.probe.agreeing < kLeastAgreeing || one.probe.free_space > kMostFreeSpace) return one;
    one.camera_from_object = settleOnDepth(model_, kSettled, one.camera_from_object, scene_);
    one.probe = probeSurface(model_, kFirstProbe, one.camera_from_object, scene_);
    return one;
  }

  int object_;
  const PreparedModel& model_;
  const SceneView& scene_;
  const std::vector<Eigen::Quaternionf>& scene_frames_;
  const ModelFeatures* features_ = nullptr;
};

Hypothesis hypothesisOf(const Suggestion& suggestion) {
  Hypothesis hypothesis;
  hypothesis.object = suggestion.object;
  hypothesis.camera_from_object = suggestion.camera_from_object;
  hypothesis.consensus = {suggestion.pair};
  return hypothesis;
}

/// Draws a suggestion to the depth and looks again.
void refine(const PreparedModels& models, const SceneView& scene, Suggestion* suggestion) {
  RefinementOptions options;
  options.iterations = kRefineIterations;
  options.samples = kRefineSamples;
  options.use_features = options.use_lightness = false;
  const PreparedModel& model = models.at(suggestion->object);
  suggestion->camera_from_object = refinePose(model, models.object(suggestion->object), hypothesisOf(*suggestion),
                                              suggestion->camera_from_object, scene, options)
                                       .camera_from_object;
  suggestion->probe = probeSurface(model, kSecondProbe, suggestion->camera_from_object, scene);
  suggestion->rate(kCorrelationRefined);
}

std::vector<Suggestion> joined(const std::vector<std::vector<Suggestion>>& by_object) {
  std::vector<Suggestion> all;
  for (const auto& own : by_object) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace

std::vector<Hypothesis> suggestPoses(const SceneMatches& matches, const std::vector<std::uint8_t>& active,
                                     const PreparedModels& models, const SceneView& scene, int count) {
  std::vector<std::vector<Suggestion>> by_object(matches.by_object.size());
  const std::vector<Eigen::Quaternionf> frames = featureFrames(*scene.features);
  const cv::Range all(0, static_cast<int>(by_object.size()));
  cv::parallel_for_(all, [&](const cv::Range& range) {
    for (int object = range.start; object < range.end; ++object)
      by_object[static_cast<size_t>(object)] =
          ObjectSuggestions(object, models, scene, frames).find(matches.by_object[static_cast<size_t>(object)], active);
  }, all.size());
  std::vector<Suggestion> suggestions = joined(by_object);
  keepPromising(kRefinedPerFrame, &suggestions);
  cv::parallel_for_(cv::Range(0, static_cast<int>(suggestions.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) refine(models, scene, &suggestions[static_cast<size_t>(i)]);
  });

  for (auto& own : by_object) own.clear();
  for (const Suggestion& one : suggestions) by_object[static_cast<size_t>(one.object)].push_back(one);
  for (size_t object = 0; object < by_object.size(); ++object)
    if (!by_object[object].empty()) keepBest(models.at(static_cast<int>(object)), kTestedPerObject, &by_object[object]);
  suggestions = joined(by_object);
  keepPromising(static_cast<size_t>(count), &suggestions);
  std::vector<Hypothesis> hypotheses;
  for (const Suggestion& one : suggestions) hypotheses.push_back(hypothesisOf(one));
  return hypotheses;
}

}  // namespace rgbd_recognition
