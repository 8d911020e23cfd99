#include "verification/hypothesis_verifier.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "verification/alternatives.h"
#include "proposals/correspondence_proposals.h"
#include "features/active_features.h"
#include "verification/hypothesis_testing.h"
#include "verification/selection.h"
#include "proposals/resting_proposals.h"
#include "verification/pixel_consistency.h"

namespace recognition {
namespace {

constexpr double kFurtherRounds = 0.5;  // of theta_c: threshold of further rounds, and of objects that stay candidates
constexpr double kSegmentShare = 0.5;   // of a segment that a detection must explain to take it away
constexpr int kExplainedMargin = 2;  // pixels by which a detection's pixels grow: keypoints on its outline are its own

/// The share of each segment whose pixels agree in depth and colour with a hypothesis (f(S) / |S| of eq. (14)) exceeds
/// one half.
std::set<int> explainedSegments(const TestedHypothesis& tested, const Segmentation& segmentation) {
  const cv::Rect& box = tested.reprojected.box;
  std::vector<int> consistent(segmentation.patches.size() + 1, 0);
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      const int label = segmentation.labels.at<int>(v + box.y, u + box.x);
      if (label > 0 && tested.pixels.state.at<PixelState>(v, u) == PixelState::kConsistent &&
          tested.pixels.color_ok.at<std::uint8_t>(v, u))
        ++consistent[static_cast<size_t>(label)];
    }
  }
  std::set<int> labels;
  if (tested.verified.scores.best_segment > 0) labels.insert(tested.verified.scores.best_segment);
  for (const Patch& patch : segmentation.patches)
    if (consistent[static_cast<size_t>(patch.label)] > kSegmentShare * patch.pixels) labels.insert(patch.label);
  return labels;
}

}  // namespace

const char* rejectionName(Rejection rejection) {
  switch (rejection) {
    case Rejection::kNone:
      return "none";
    case Rejection::kConsistency:
      return "consistency";
    case Rejection::kTooLittleSeen:
      return "too_little_seen";
    case Rejection::kFreeSpace:
      return "free_space";
    case Rejection::kConsensus:
      return "consensus";
    case Rejection::kConflict:
      return "conflict";
    case Rejection::kDuplicate:
      return "duplicate";
    case Rejection::kOutOfView:
      return "out_of_view";
  }
  return "";
}

class HypothesisVerifier::Impl {
 public:
  Impl(const VerificationParameters& parameters, std::shared_ptr<const PreparedModels> models, const SceneView& scene)
      : parameters_(parameters),
        models_(std::move(models)),
        scene_(scene),
        segmentation_(*scene.segmentation),
        explained_(scene.depth.size(), CV_8UC1, cv::Scalar(0)) {
    parameters_.validate();
  }

  RoundOutcome verify(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches) {
    for (const Hypothesis& hypothesis : hypotheses) checkIndices(hypothesis.object, hypothesis.consensus);
    if (matches) check(*matches);
    if (round > 0 && parameters_.decision == Decision::kPaper) removeExplainedSegments();
    RoundOutcome outcome;
    std::set<int> candidates;
    bool found = testAndChoose(hypotheses, round, &outcome, &candidates);
    if (matches && parameters_.decision != Decision::kPaper) {
      const auto test = [&](std::vector<Hypothesis> proposals) {
        for (Hypothesis& proposal : proposals) proposal.round = round;
        found |= testAndChoose(proposals, round, &outcome, &candidates);
      };
      if (parameters_.correspondence_proposals > 0) test(proposeByCorrespondences(*matches));
      if (parameters_.resting_proposals > 0) test(proposeByShape(*matches));
    }
    outcome.candidates.assign(candidates.begin(), candidates.end());
    outcome.explained = explained_;
    outcome.finished = !found || outcome.candidates.empty() || round + 1 >= parameters_.max_rounds;
    return outcome;
  }

  std::vector<VerifiedHypothesis> detections() const {
    std::vector<VerifiedHypothesis> out;
    for (const TestedHypothesis& one : accepted_) out.push_back(one.verified);
    std::stable_sort(out.begin(), out.end(), [](const VerifiedHypothesis& a, const VerifiedHypothesis& b) {
      return a.confidence > b.confidence;
    });
    return out;
  }

 private:
  /// Adds what was tested and what is worth a further round; whether something was found.
  bool testAndChoose(const std::vector<Hypothesis>& hypotheses, int round, RoundOutcome* outcome,
                     std::set<int>* candidates) {
    std::vector<TestedHypothesis> tested = testAll(strongest(hypotheses), round);
    std::vector<TestedHypothesis*> pool;
    for (TestedHypothesis& earlier : accepted_) pool.push_back(&earlier);
    for (TestedHypothesis& one : tested) pool.push_back(&one);
    select(pool);
    bool found = false;
    for (const TestedHypothesis& one : tested) {
      outcome->hypotheses.push_back(one.verified);
      found |= one.verified.accepted();
      if (mayBeThereAgain(one.verified)) candidates->insert(one.verified.hypothesis.object);
    }
    keepAccepted(std::move(tested));
    if (found) explained_ = explained();  // else the same ones stay
    return found;
  }

  std::vector<Hypothesis> proposeByCorrespondences(const SceneMatches& matches) const {
    const auto active = activeFeatures(*scene_.features, explained_, scene_.color_per_depth);
    return proposeByCorrespondence(matches, active, *models_, scene_, parameters_.correspondence_proposals);
  }

  /// Of objects that were looked for: any that is has some match in the frame, right or wrong.
  std::vector<Hypothesis> proposeByShape(const SceneMatches& matches) const {
    std::vector<int> objects;
    for (size_t i = 0; i < matches.by_object.size(); ++i)
      if (!matches.by_object[i].empty()) objects.push_back(static_cast<int>(i));
    return proposeRestingPoses(objects, explained_, *models_, scene_, parameters_.resting_proposals);
  }

  void check(const SceneMatches& matches) const {
    if (matches.by_object.size() != static_cast<size_t>(models_->count()))
      throw std::invalid_argument("matches of " + std::to_string(matches.by_object.size()) + " objects, not " +
                                  std::to_string(models_->count()));
    for (int object = 0; object < models_->count(); ++object)
      checkIndices(object, matches.by_object[static_cast<size_t>(object)]);
  }

  void checkIndices(int object, const std::vector<Correspondence>& pairs) const {
    if (object < 0 || object >= models_->count())
      throw std::invalid_argument("hypothesis of object " + std::to_string(object) + " of " +
                                  std::to_string(models_->count()));
    const auto own = models_->object(object).features.find(scene_.features->image.type);
    const int model_features =
        own == models_->object(object).features.end() ? 0 : static_cast<int>(own->second.positions.size());
    const int scene_features = static_cast<int>(scene_.features->points.size());
    for (const Correspondence& c : pairs)
      if (c.scene_feature < 0 || c.scene_feature >= scene_features || c.model_feature < 0 ||
          c.model_feature >= model_features)
        throw std::invalid_argument("correspondence of scene feature " + std::to_string(c.scene_feature) + " of " +
                                    std::to_string(scene_features) + " with model feature " +
                                    std::to_string(c.model_feature) + " of " + std::to_string(model_features));
  }

  std::vector<const Hypothesis*> strongest(const std::vector<Hypothesis>& hypotheses) const {
    std::vector<const Hypothesis*> order;
    for (const Hypothesis& h : hypotheses) order.push_back(&h);
    std::stable_sort(order.begin(), order.end(), [](const Hypothesis* a, const Hypothesis* b) {
      return a->consensus.size() > b->consensus.size();
    });
    if (order.size() > static_cast<size_t>(parameters_.max_hypotheses))
      order.resize(static_cast<size_t>(parameters_.max_hypotheses));
    return order;
  }

  /// Each hypothesis, followed by those of its alternatives that are worth a choice.
  std::vector<TestedHypothesis> testAll(const std::vector<const Hypothesis*>& hypotheses, int round) const {
    const double theta_c = round == 0 ? parameters_.theta_c : kFurtherRounds * parameters_.theta_c;
    std::vector<std::vector<TestedHypothesis>> tested(hypotheses.size());
    const cv::Range all(0, static_cast<int>(hypotheses.size()));
    cv::parallel_for_(
        all,
        [&](const cv::Range& range) {
          for (int i = range.start; i < range.end; ++i)
            tested[static_cast<size_t>(i)] = testOne(*hypotheses[static_cast<size_t>(i)], theta_c);
        },
        all.size());
    std::vector<TestedHypothesis> flat;
    for (std::vector<TestedHypothesis>& one : tested) std::move(one.begin(), one.end(), std::back_inserter(flat));
    return flat;
  }

  std::vector<TestedHypothesis> testOne(const Hypothesis& hypothesis, double theta_c) const {
    std::vector<TestedHypothesis> tested;
    tested.push_back(testHypothesis(hypothesis, models_->object(hypothesis.object), models_->at(hypothesis.object),
                                    scene_, segmentation_, parameters_, theta_c));
    const VerifiedHypothesis& own = tested[0].verified;
    if (parameters_.decision == Decision::kPaper || !parameters_.test_alternatives || own.scores.projected == 0 ||
        lacksConsensus(hypothesis.source))
      return tested;
    if (own.evidence.inliers < parameters_.min_consensus || own.scores.free_space > parameters_.max_free_space)
      return tested;
    for (TestedHypothesis& other : testAlternatives(tested[0], *models_, scene_, segmentation_, parameters_))
      if (other.verified.accepted()) tested.push_back(std::move(other));
    return tested;
  }

  void select(const std::vector<TestedHypothesis*>& pool) const {
    if (parameters_.decision == Decision::kPaper)
      selectBySegment(*models_, pool);
    else
      selectByPixels(*models_, pool, scene_.depth.size(), parameters_.max_overlap);
  }

  /// Its consistency is above half of what acceptance asks for: the object may be there once more, or behind what is
  /// explained now.
  bool mayBeThereAgain(const VerifiedHypothesis& v) const {
    return parameters_.decision == Decision::kPaper ? v.scores.total > kFurtherRounds * parameters_.theta_c
                                                    : v.confidence > parameters_.candidateConfidence();
  }

  void keepAccepted(std::vector<TestedHypothesis> tested) {
    std::vector<TestedHypothesis> kept;
    for (std::vector<TestedHypothesis>* from : {&accepted_, &tested})
      for (TestedHypothesis& one : *from)
        if (one.verified.accepted()) kept.push_back(std::move(one));
    accepted_ = std::move(kept);
  }

  /// S of a further round: the segments of what is recognised are gone.
  void removeExplainedSegments() {
    const std::set<int> labels = takenSegments();
    segmentation_.labels = scene_.segmentation->labels.clone();
    segmentation_.labels.forEach<int>([&](int& label, const int*) {
      if (label > 0 && labels.count(label)) label = kUnlabelled;
    });
  }

  std::set<int> takenSegments() const {
    std::set<int> labels;
    for (const TestedHypothesis& one : accepted_) labels.merge(explainedSegments(one, *scene_.segmentation));
    return labels;
  }

  cv::Mat explained() const {
    cv::Mat mask(scene_.depth.size(), CV_8UC1, cv::Scalar(0));
    if (parameters_.decision == Decision::kPaper) {
      for (const int label : takenSegments()) mask.setTo(255, scene_.segmentation->labels == label);
      return mask;
    }
    for (const TestedHypothesis& one : accepted_) {
      cv::Mat seen = one.pixels.state == static_cast<int>(PixelState::kConsistent);
      seen |= one.pixels.state == static_cast<int>(PixelState::kUnknown);
      mask(one.reprojected.box).setTo(255, seen);
    }
    const int size = 2 * kExplainedMargin + 1;
    cv::dilate(mask, mask, cv::Mat::ones(size, size, CV_8UC1));
    return mask;
  }

  VerificationParameters parameters_;
  std::shared_ptr<const PreparedModels> models_;
  SceneView scene_;
  Segmentation segmentation_;  // of this round
  std::vector<TestedHypothesis> accepted_;
  cv::Mat explained_;  // CV_8UC1, 255 where these explain the frame; a new one each time
};

HypothesisVerifier::HypothesisVerifier(const VerificationParameters& parameters, const ModelDatabase& database,
                                       const SceneView& scene)
    : HypothesisVerifier(parameters, std::make_shared<const PreparedModels>(database), scene) {}

HypothesisVerifier::HypothesisVerifier(const VerificationParameters& parameters,
                                       std::shared_ptr<const PreparedModels> models, const SceneView& scene)
    : impl_(std::make_unique<Impl>(parameters, std::move(models), scene)) {}

HypothesisVerifier::~HypothesisVerifier() = default;

RoundOutcome HypothesisVerifier::verify(const std::vector<Hypothesis>& hypotheses, int round,
                                        const SceneMatches* matches) {
  return impl_->verify(hypotheses, round, matches);
}

std::vector<VerifiedHypothesis> HypothesisVerifier::detections() const { return impl_->detections(); }

}  // namespace recognition
