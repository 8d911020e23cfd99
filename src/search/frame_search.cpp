#include "search/frame_search.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "proposals/pose_proposer.h"
#include "search/check_hypotheses.h"
#include "search/explained_segments.h"
#include "search/search_queue.h"
#include "search/search_state.h"
#include "verification/alternatives.h"

namespace recognition {
namespace {

/// Hypotheses that climb side by side before what they explain is taken off; fixed, whatever the number of threads.
constexpr int kRefusedFactor = 2;  // of min_consensus: a refused set that is worth a look at its alternatives
constexpr size_t kAtATime = 4;

/// Work of the levels, about milliseconds of one core of 2.5 GHz for an object of average size: estimates.
constexpr std::array<double, kTestLevels> kLevelWork = {0.0, 0.01, 0.4, 0.4, 0.6, 1.2};

double workOf(const TestedHypothesis& tested) {
  double work = 0.0;
  for (int level = 1; level <= static_cast<int>(tested.verified.level); ++level)
    work += kLevelWork[static_cast<size_t>(level)];
  return work;
}

}  // namespace

class FrameSearch::Impl {
 public:
  Impl(const VerificationParameters& parameters, const MatchingLimits& limits,
       std::shared_ptr<const PreparedModels> models, const SceneView& scene, double work_ms)
      : parameters_(parameters),
        limits_(limits),
        models_(std::move(models)),
        scene_(scene),
        segmentation_(*scene.segmentation),
        state_(scene.depth.size(), work_ms) {
    parameters_.validate();
    if (!(work_ms >= 0.0)) throw std::invalid_argument("work budget of " + std::to_string(work_ms) + " ms is negative");
  }

  RoundOutcome run(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches) {
    checkHypotheses(hypotheses, *models_, scene_);
    if (matches) checkMatches(*matches, *models_, scene_);
    const bool paper = parameters_.decision == Decision::kPaper;
    if (round > 0 && paper)
      segmentation_ = without(*scene_.segmentation, explainedSegments(state_.accepted(), *scene_.segmentation));
    rule_ = makeAcceptanceRule(parameters_, round);
    RoundOutcome outcome;
    bool found = search(hypotheses, &outcome);
    if (matches && !paper)
      for (const auto& proposer : makeProposers(parameters_)) found |= searchProposals(*proposer, *matches, &outcome);
    finish(found, round, &outcome);
    return outcome;
  }

  std::vector<VerifiedHypothesis> detections() const {
    std::vector<VerifiedHypothesis> out;
    for (const TestedHypothesis& one : state_.accepted()) out.push_back(one.verified);
    std::stable_sort(out.begin(), out.end(), [](const VerifiedHypothesis& a, const VerifiedHypothesis& b) {
      return a.confidence > b.confidence;
    });
    return out;
  }

  const SearchReport& report() const { return state_.report(); }

 private:
  PoseVerification verification() const { return {parameters_, limits_, *models_, scene_, segmentation_, *rule_}; }

  bool searchProposals(const PoseProposer& proposer, const SceneMatches& matches, RoundOutcome* outcome) {
    if (state_.exhausted()) {
      state_.report().left_out.push_back("poses that follow the consensus sets");
      return false;
    }
    return search(proposer.propose({scene_, *models_, matches, state_.explained(), limits_}), outcome);
  }

  /// Tests hypotheses the best first; whether something was found.
  bool search(const std::vector<Hypothesis>& hypotheses, RoundOutcome* outcome) {
    SearchQueue queue = lineUp(hypotheses, outcome);
    const size_t at_a_time = rule_->refusesEarly() ? kAtATime : std::max<size_t>(1, queue.size());
    bool found = false;
    while (!queue.empty()) {
      std::vector<TestedHypothesis> batch = queue.take(at_a_time);
      if (state_.exhausted())
        leaveOut(queue.size() + batch.size(), &batch);
      else
        climb(&batch);
      if (state_.choose(*rule_, *models_, scene_, &batch)) {
        found = true;
        explain();
      }
      record(batch, outcome);
    }
    return found;
  }

  /// Looks at all hypotheses with a few points; those that this refuses are recorded at once.
  SearchQueue lineUp(const std::vector<Hypothesis>& hypotheses, RoundOutcome* outcome) {
    const std::vector<const Hypothesis*> order = strongest(hypotheses);
    std::vector<TestedHypothesis> looked_at(order.size());
    const PoseVerification test = verification();
    forAll(order.size(), [&](size_t i) {
      looked_at[i] = test.begin(*order[i]);
      test.advanceTo(TestLevel::kProbed, &looked_at[i]);
    });
    SearchQueue queue;
    std::vector<TestedHypothesis> refused;
    for (TestedHypothesis& one : looked_at) {
      if (one.finished()) {
        refused.push_back(std::move(one));
        continue;
      }
      const double bound = boundOf(one);  // before it is moved from
      queue.push(std::move(one), bound);
    }
    record(refused, outcome);
    return queue;
  }

  /// A consensus set cannot gain members, so its size bounds the inliers.
  double boundOf(const TestedHypothesis& tested) const {
    VerifiedHypothesis most = tested.verified;
    if (!lacksConsensus(most.hypothesis.source))
      most.evidence.inliers = static_cast<int>(most.hypothesis.consensus.size());
    return rule_->bound(most);
  }

  std::vector<const Hypothesis*> strongest(const std::vector<Hypothesis>& hypotheses) {
    std::vector<const Hypothesis*> order;
    for (const Hypothesis& h : hypotheses) order.push_back(&h);
    std::stable_sort(order.begin(), order.end(), [](const Hypothesis* a, const Hypothesis* b) {
      return a->consensus.size() > b->consensus.size();
    });
    const auto limit = static_cast<size_t>(parameters_.max_hypotheses);
    if (order.size() > limit) {
      state_.report().left_out.push_back(std::to_string(order.size() - limit) + " hypotheses beyond max_hypotheses");
      order.resize(limit);
    }
    return order;
  }

  /// To the end of the test, and the alternatives of what may be right.
  void climb(std::vector<TestedHypothesis>* batch) {
    const PoseVerification test = verification();
    std::vector<std::vector<TestedHypothesis>> alternatives(batch->size());
    forAll(batch->size(), [&](size_t i) {
      TestedHypothesis& one = (*batch)[i];
      if (skip(&one.verified)) return;
      test.advanceTo(TestLevel::kCompared, &one);
      if (mayHaveAlternatives(one)) alternatives[i] = testAlternatives(one, *models_, scene_, test);
    });
    for (const TestedHypothesis& one : *batch) state_.spend(workOf(one));
    for (std::vector<TestedHypothesis>& some : alternatives)
      for (TestedHypothesis& other : some) {
        state_.spend(workOf(other));
        if (other.verified.accepted()) batch->push_back(std::move(other));
      }
  }

  bool skip(VerifiedHypothesis* verified) const {
    if (!rule_->refusesEarly()) return false;
    const TestedHypothesis* better = state_.explanationOf(verified->hypothesis, scene_);
    if (!better) return false;
    verified->rejection = Rejection::kExplained;
    verified->conflict_with = models_->object(better->verified.hypothesis.object).name;
    return true;
  }

  /// A consensus set whose pose the appearance refuses may be a texture that repeats on the object, or a twin's.
  bool mayHaveAlternatives(const TestedHypothesis& tested) const {
    const VerifiedHypothesis& verified = tested.verified;
    const bool refused_by_looks = verified.rejection == Rejection::kCoarse || verified.rejection == Rejection::kBound;
    const int min_inliers = (refused_by_looks ? kRefusedFactor : 1) * parameters_.min_consensus;
    return parameters_.test_alternatives && parameters_.decision != Decision::kPaper &&
           (verified.level == TestLevel::kCompared || refused_by_looks) &&
           !lacksConsensus(verified.hypothesis.source) && verified.evidence.inliers >= min_inliers;
  }

  void leaveOut(size_t count, std::vector<TestedHypothesis>* batch) {
    for (TestedHypothesis& one : *batch) one.verified.rejection = Rejection::kBudget;
    if (reported_budget_) return;
    reported_budget_ = true;
    state_.report().left_out.push_back(std::to_string(count) + " hypotheses");
  }

  void record(const std::vector<TestedHypothesis>& tested, RoundOutcome* outcome) {
    for (const TestedHypothesis& one : tested) {
      outcome->hypotheses.push_back(one.verified);
      state_.report().funnel.add(one.verified);
      if (rule_->staysCandidate(one.verified)) candidates_.insert(one.verified.hypothesis.object);
    }
  }

  void explain() {
    if (parameters_.decision == Decision::kPaper)
      state_.explain(maskOf(*scene_.segmentation, explainedSegments(state_.accepted(), *scene_.segmentation)));
    else
      state_.explain(explainedPixels(state_.accepted(), scene_.depth.size()));
  }

  void finish(bool found, int round, RoundOutcome* outcome) {
    outcome->candidates.assign(candidates_.begin(), candidates_.end());
    candidates_.clear();
    outcome->explained = state_.explained();
    outcome->finished = !found || outcome->candidates.empty() || round + 1 >= parameters_.max_rounds;
  }

  template <typename Work>
  static void forAll(size_t count, const Work& work) {
    const cv::Range all(0, static_cast<int>(count));
    cv::parallel_for_(
        all,
        [&](const cv::Range& range) {
          for (int i = range.start; i < range.end; ++i) work(static_cast<size_t>(i));
        },
        all.size());
  }

  VerificationParameters parameters_;
  MatchingLimits limits_;
  std::shared_ptr<const PreparedModels> models_;
  const SceneView& scene_;
  Segmentation segmentation_;             // of this round
  std::unique_ptr<AcceptanceRule> rule_;  // likewise
  SearchState state_;
  std::set<int> candidates_;  // for the next round
  bool reported_budget_ = false;
};

FrameSearch::FrameSearch(const VerificationParameters& parameters, const MatchingLimits& limits,
                         std::shared_ptr<const PreparedModels> models, const SceneView& scene, double work_ms)
    : impl_(std::make_unique<Impl>(parameters, limits, std::move(models), scene, work_ms)) {}

FrameSearch::FrameSearch(const VerificationParameters& parameters, const ModelDatabase& database,
                         const SceneView& scene)
    : FrameSearch(parameters, {}, std::make_shared<const PreparedModels>(database), scene) {}

FrameSearch::~FrameSearch() = default;

RoundOutcome FrameSearch::run(const std::vector<Hypothesis>& hypotheses, int round, const SceneMatches* matches) {
  return impl_->run(hypotheses, round, matches);
}

std::vector<VerifiedHypothesis> FrameSearch::detections() const { return impl_->detections(); }

const SearchReport& FrameSearch::report() const { return impl_->report(); }

void SearchFunnel::add(const VerifiedHypothesis& hypothesis) {
  Counts& counts = by_source[static_cast<size_t>(hypothesis.hypothesis.source)];
  for (int level = 0; level <= static_cast<int>(hypothesis.level); ++level)
    ++counts.reached[static_cast<size_t>(level)];
  counts.accepted += hypothesis.accepted() ? 1 : 0;
}

}  // namespace recognition
