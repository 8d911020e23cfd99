#include "verification/acceptance_rule.h"

#include <algorithm>

#include "verification/confidence.h"
#include "verification/selection.h"

namespace recognition {
namespace {

constexpr double kFurtherRounds = 0.5;  // of theta_c: threshold of further rounds, and of objects that stay candidates
constexpr double kProposalFreeSpace = 0.12;  // largest of a pose without a consensus set
constexpr double kMaxProposalColor = 25.0;   // CIELAB; right ones on real frames have 8 to 17
// Colours must correlate better at a pose without a consensus set than beside it. On the five real frames, hard 2001,
// hard 2003 and wide 1003 this refuses 2098 of 2849 such poses, and none of the 29 that were accepted, right or wrong.
constexpr double kMinProposalPeak = 0.0;
constexpr int kMinTextureMatches = 1;  // features that match at their places, of a pose proposed by shape
// Nats, of a pose without a consensus set: its features match better there than beside it. Chosen on wide 1001 to 1003,
// hard 2001 and the even frames of the shelf: 2 of 4 wrong ones are refused, and 1 of 29 right ones.
constexpr double kMinSignificance = 0.05;

// Of any pose: where features match no better than beside it (nats), light must tell it from one beside it (structure).
// Chosen on wide 1001 to 1003, hard 2001, the real sets, and a store of the sugar box alone in the demo's frames, where a
// wrong set of 36 inliers was accepted: of 378 right consensus sets two are refused, both in stacked cartons.
constexpr double kVagueSignificance = 0.3, kVagueStructure = 0.3;

class PaperRule : public AcceptanceRule {
 public:
  PaperRule(const VerificationParameters& parameters, int round)
      : parameters_(parameters),
        threshold_(round > 0 && parameters.further_rounds == FurtherRounds::kAcceptance
                       ? kFurtherRounds * parameters.theta_c
                       : parameters.theta_c) {}

  bool refusesEarly() const override { return false; }
  Rejection byPeak(const VerifiedHypothesis&) const override { return Rejection::kNone; }
  Rejection byDepth(const VerifiedHypothesis& hypothesis) const override {
    return hypothesis.scores.projected == 0 ? Rejection::kOutOfView : Rejection::kNone;
  }
  double bound(const VerifiedHypothesis&) const override { return 1.0; }
  bool mayBecomeAccepted(const VerifiedHypothesis&) const override { return true; }
  Rejection byFeatures(const VerifiedHypothesis&) const override { return Rejection::kNone; }
  void decide(VerifiedHypothesis* hypothesis) const override {
    hypothesis->confidence = std::min(1.0, hypothesis->scores.total);
    hypothesis->rejection =
        hypothesis->scores.total >= threshold_ ? Rejection::kNone : Rejection::kConsistency;  // eq. (17)
  }
  void select(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses,
              const SceneView&) const override {
    selectBySegment(models, hypotheses);
  }
  bool staysCandidate(const VerifiedHypothesis& hypothesis) const override {
    return hypothesis.scores.total > kFurtherRounds * parameters_.theta_c;
  }

 private:
  VerificationParameters parameters_;
  double threshold_;
};

class ConfidenceRule : public AcceptanceRule {
 public:
  explicit ConfidenceRule(const VerificationParameters& parameters) : parameters_(parameters) {}

  bool refusesEarly() const override { return !parameters_.exhaustive; }
  Rejection byPeak(const VerifiedHypothesis& hypothesis) const override {
    const bool beside = lacksConsensus(hypothesis.hypothesis.source) && hypothesis.evidence.peak < kMinProposalPeak;
    return beside ? Rejection::kIndistinct : Rejection::kNone;
  }
  Rejection byDepth(const VerifiedHypothesis& hypothesis) const override {
    const ConsistencyScores& scores = hypothesis.scores;
    const HypothesisSource source = hypothesis.hypothesis.source;
    if (scores.projected == 0) return Rejection::kOutOfView;
    if (scores.visible < parameters_.min_visible) return Rejection::kTooLittleSeen;
    if (scores.free_space > parameters_.max_free_space) return Rejection::kFreeSpace;
    if (lacksConsensus(source))
      return scores.free_space > kProposalFreeSpace ? Rejection::kFreeSpace : Rejection::kNone;
    if (source == HypothesisSource::kAlternative) return Rejection::kNone;  // its features are counted last
    return hypothesis.evidence.inliers < parameters_.min_consensus ? Rejection::kConsensus : Rejection::kNone;
  }
  double bound(const VerifiedHypothesis& hypothesis) const override { return maxConfidence(hypothesis); }
  bool mayBecomeAccepted(const VerifiedHypothesis& hypothesis) const override {
    return confidenceWithFeatures(hypothesis) >= parameters_.min_confidence;
  }
  Rejection byFeatures(const VerifiedHypothesis& hypothesis) const override {
    const HypothesisSource source = hypothesis.hypothesis.source;
    const int min_inliers = source == HypothesisSource::kAlternative ? parameters_.min_consensus
                            : source == HypothesisSource::kShape     ? kMinTextureMatches
                                                                     : 0;
    const bool beside = lacksConsensus(source) && hypothesis.evidence.significance < kMinSignificance;
    return beside || hypothesis.evidence.inliers < min_inliers ? Rejection::kConsensus : Rejection::kNone;
  }
  void decide(VerifiedHypothesis* hypothesis) const override {
    hypothesis->confidence = confidence(hypothesis->evidence, hypothesis->hypothesis.source);
    // What few features or none propose must have the object's colours: no illumination changes them so much.
    if (lacksConsensus(hypothesis->hypothesis.source) && hypothesis->evidence.color_distance > kMaxProposalColor)
      hypothesis->confidence = 0.0;
    hypothesis->rejection =
        hypothesis->confidence >= parameters_.min_confidence ? Rejection::kNone : Rejection::kConsistency;
    for (const Rejection gate : {byPeak(*hypothesis), byFeatures(*hypothesis)})
      if (gate != Rejection::kNone) hypothesis->rejection = gate;
    const Evidence& evidence = hypothesis->evidence;
    if (evidence.significance < kVagueSignificance && evidence.structure < kVagueStructure)
      hypothesis->rejection = Rejection::kIndistinct;
  }
  void select(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses,
              const SceneView& scene) const override {
    selectByPixels(models, hypotheses, scene, parameters_.max_overlap);
  }
  bool staysCandidate(const VerifiedHypothesis&) const override { return false; }

 private:
  VerificationParameters parameters_;
};

}  // namespace

std::unique_ptr<AcceptanceRule> makeAcceptanceRule(const VerificationParameters& parameters, int round) {
  if (parameters.decision == Decision::kPaper) return std::make_unique<PaperRule>(parameters, round);
  return std::make_unique<ConfidenceRule>(parameters);
}

}  // namespace recognition
