#include "proposals/proposal_ranking.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/utility.hpp>

#include "alignment/pose_refiner.h"
#include "alignment/prepared_model.h"
#include "core/angles.h"

namespace recognition {
namespace {

constexpr double kSameDistance = 0.015, kSameRotation = 15.0;  // metres, degrees
constexpr int kRefineIterations = 5, kRefineSamples = 120;
constexpr double kCorrelationFirst = 4.0, kCorrelationRefined = 7.0, kSupportWeight = 1.5, kFreeSpaceWeight = 2.0;

bool samePose(const Proposal& a, const Proposal& b, const Eigen::Vector3d& centre) {
  if ((a.camera_from_object * centre - b.camera_from_object * centre).norm() > kSameDistance) return false;
  const double trace = (a.camera_from_object.linear().transpose() * b.camera_from_object.linear()).trace();
  return trace > 1.0 + 2.0 * std::cos(kSameRotation * kDegree);
}

Hypothesis hypothesisOf(const Proposal& proposal) {
  Hypothesis hypothesis;
  hypothesis.object = proposal.object;
  hypothesis.camera_from_object = proposal.camera_from_object;
  hypothesis.source = proposal.pair ? HypothesisSource::kCorrespondence : HypothesisSource::kShape;
  if (proposal.pair) hypothesis.consensus = {*proposal.pair};
  return hypothesis;
}

void refine(const PreparedModels& models, const SceneView& scene, Proposal* proposal) {
  RefinementOptions options;
  options.iterations = kRefineIterations;
  options.samples = kRefineSamples;
  options.use_features = options.use_lightness = false;
  const PreparedModel& model = models.at(proposal->object);
  proposal->camera_from_object = refinePose(model, models.object(proposal->object), hypothesisOf(*proposal),
                                            proposal->camera_from_object, scene, options)
                                     .camera_from_object;
  proposal->probe = probeSurface(model, kSecondProbe, proposal->camera_from_object, scene);
  proposal->rate(true);
}

std::vector<Proposal> joined(const std::vector<std::vector<Proposal>>& by_object) {
  std::vector<Proposal> all;
  for (const auto& own : by_object) all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace

void Proposal::rate(bool refined) {
  priority = probe.agreeing - kFreeSpaceWeight * probe.free_space +
             (refined ? kCorrelationRefined : kCorrelationFirst) * probe.correlation + kSupportWeight * support;
}

void keepBest(size_t count, std::vector<Proposal>* proposals) {
  std::stable_sort(proposals->begin(), proposals->end(),
                   [](const Proposal& a, const Proposal& b) { return a.priority > b.priority; });
  if (proposals->size() > count) proposals->resize(count);
}

void keepDistinct(const PreparedModel& model, size_t count, std::vector<Proposal>* proposals) {
  keepBest(proposals->size(), proposals);
  std::vector<Proposal> kept;
  for (const Proposal& one : *proposals) {
    if (kept.size() == count) break;
    const auto same = [&](const Proposal& other) { return samePose(one, other, model.centre.cast<double>()); };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(one);
  }
  *proposals = std::move(kept);
}

std::vector<Hypothesis> hypothesesOf(std::vector<std::vector<Proposal>> by_object, const PreparedModels& models,
                                     const SceneView& scene, const ProposalLimits& limits) {
  std::vector<Proposal> proposals = joined(by_object);
  keepBest(limits.refined, &proposals);
  cv::parallel_for_(cv::Range(0, static_cast<int>(proposals.size())), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) refine(models, scene, &proposals[static_cast<size_t>(i)]);
  });

  for (auto& own : by_object) own.clear();
  for (const Proposal& one : proposals)
    if (one.probe.free_space <= limits.free_space) by_object[static_cast<size_t>(one.object)].push_back(one);
  for (size_t object = 0; object < by_object.size(); ++object)
    if (!by_object[object].empty())
      keepDistinct(models.at(static_cast<int>(object)), limits.tested_per_object, &by_object[object]);
  proposals = joined(by_object);
  keepBest(limits.tested, &proposals);
  std::vector<Hypothesis> hypotheses;
  for (const Proposal& one : proposals) hypotheses.push_back(hypothesisOf(one));
  return hypotheses;
}

}  // namespace recognition
