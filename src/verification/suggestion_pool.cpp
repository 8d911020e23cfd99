#include "suggestion_pool.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>

#include "rgbd_recognition/verification/pose_refiner.h"

namespace rgbd_recognition {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSameDistance = 0.015, kSameRotation = 15.0;  // metres, degrees
constexpr int kRefineIterations = 5, kRefineSamples = 120;
constexpr double kCorrelationFirst = 4.0, kCorrelationRefined = 7.0, kSupportWeight = 1.5, kFreeSpaceWeight = 2.0;

bool samePose(const Suggestion& a, const Suggestion& b, const Eigen::Vector3d& centre) {
  if ((a.camera_from_object * centre - b.camera_from_object * centre).norm() > kSameDistance) return false;
  const double trace = (a.camera_from_object.linear().transpose() * b.camera_from_object.linear()).trace();
  return trace > 1.0 + 2.0 * std::cos(kSameRotation * kPi / 180.0);
}

Hypothesis hypothesisOf(const Suggestion& suggestion) {
  Hypothesis hypothesis;
  hypothesis.object = suggestion.object;
  hypothesis.camera_from_object = suggestion.camera_from_object;
  hypothesis.source = suggestion.pair ? HypothesisSource::kCorrespondence : HypothesisSource::kShape;
  if (suggestion.pair) hypothesis.consensus = {*suggestion.pair};
  return hypothesis;
}

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
  suggestion->rate(true);
}

std::vector<Suggestion> joined(const std::vector<std::vector<Suggestion>>& by_object) {
  std::vector<Suggestion> all;
  for (const auto& own : by_object) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace

void Suggestion::rate(bool refined) {
  promise = probe.agreeing - kFreeSpaceWeight * probe.free_space +
            (refined ? kCorrelationRefined : kCorrelationFirst) * probe.correlation + kSupportWeight * support;
}

void keepPromising(size_t count, std::vector<Suggestion>* suggestions) {
  std::stable_sort(suggestions->begin(), suggestions->end(),
                   [](const Suggestion& a, const Suggestion& b) { return a.promise > b.promise; });
  if (suggestions->size() > count) suggestions->resize(count);
}

void keepDistinct(const PreparedModel& model, size_t count, std::vector<Suggestion>* suggestions) {
  keepPromising(suggestions->size(), suggestions);
  std::vector<Suggestion> kept;
  for (const Suggestion& one : *suggestions) {
    if (kept.size() == count) break;
    const auto same = [&](const Suggestion& other) { return samePose(one, other, model.centre.cast<double>()); };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(one);
  }
  *suggestions = std::move(kept);
}

std::vector<Hypothesis> hypothesesOf(std::vector<std::vector<Suggestion>> by_object, const PreparedModels& models,
                                     const SceneView& scene, const SuggestionLimits& limits) {
  std::vector<Suggestion> suggestions = joined(by_object);
  keepPromising(limits.refined, &suggestions);
  cv::parallel_for_(cv::Range(0, static_cast<int>(suggestions.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) refine(models, scene, &suggestions[static_cast<size_t>(i)]);
  });

  for (auto& own : by_object) own.clear();
  for (const Suggestion& one : suggestions)
    if (one.probe.free_space <= limits.free_space) by_object[static_cast<size_t>(one.object)].push_back(one);
  for (size_t object = 0; object < by_object.size(); ++object)
    if (!by_object[object].empty())
      keepDistinct(models.at(static_cast<int>(object)), limits.tested_per_object, &by_object[object]);
  suggestions = joined(by_object);
  keepPromising(limits.tested, &suggestions);
  std::vector<Hypothesis> hypotheses;
  for (const Suggestion& one : suggestions) hypotheses.push_back(hypothesisOf(one));
  return hypotheses;
}

}  // namespace rgbd_recognition
