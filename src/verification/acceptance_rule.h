#pragma once

#include <memory>
#include <vector>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

struct TestedHypothesis;

/// Decides which tested hypotheses are objects. One rule a round; immutable.
class AcceptanceRule {
 public:
  virtual ~AcceptanceRule() = default;

  /// Whether the levels below TestLevel::kCompared may refuse; if not, every hypothesis is compared in full.
  virtual bool refusesEarly() const = 0;
  /// What the colours of a few points say against a hypothesis, once Evidence::peak is measured.
  virtual Rejection byPeak(const VerifiedHypothesis& hypothesis) const = 0;
  /// What depth alone says against a hypothesis at TestLevel::kReprojected.
  virtual Rejection byDepth(const VerifiedHypothesis& hypothesis) const = 0;
  /// The most that its confidence can still become, by the evidence of the levels that it has reached.
  virtual double bound(const VerifiedHypothesis& hypothesis) const = 0;
  /// Whether the features on its surface, the last evidence to be counted, can still make it accepted.
  virtual bool mayBecomeAccepted(const VerifiedHypothesis& hypothesis) const = 0;
  /// What the features on its surface say against a hypothesis, once they are counted.
  virtual Rejection byFeatures(const VerifiedHypothesis& hypothesis) const = 0;
  /// Sets confidence and rejection of a hypothesis at TestLevel::kCompared.
  virtual void decide(VerifiedHypothesis* hypothesis) const = 0;
  /// Chooses among accepted hypotheses that exclude each other: the losers get kConflict or kDuplicate.
  virtual void select(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses,
                      const SceneView& scene) const = 0;
  /// Whether the object may be there once more, or behind what is explained: a candidate of the next round.
  virtual bool staysCandidate(const VerifiedHypothesis& hypothesis) const = 0;
};

/// The rule of VerificationParameters::decision in a round. Of Decision::kPaper: eq. (17) with theta_c in round 0 and
/// theta_c / 2 (FurtherRounds::kAcceptance) in further ones, conflicts by the best segment S*.
std::unique_ptr<AcceptanceRule> makeAcceptanceRule(const VerificationParameters& parameters, int round);

}  // namespace recognition
