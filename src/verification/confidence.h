#pragma once

#include <array>

#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

/// What the confidence is computed from, each value of order one and larger where more speaks for the hypothesis:
/// log(1 + inliers), inliers (up to 40, over 10), log(1 + significance), structure, peak, colour distance (negative, over
/// 10), depth fit, segment share, change of chroma (negative, over 10).
constexpr int kConfidenceInputs = 9;
using ConfidenceInputs = std::array<double, kConfidenceInputs>;

ConfidenceInputs confidenceInputs(const Evidence& evidence);

/// Probability that a hypothesis is right: a logistic model over confidenceInputs() whose weights are not negative, so
/// that no evidence for a hypothesis counts against it. One set of weights for hypotheses with a consensus set and
/// their alternatives, one for those without. The weights are data: src/verification/confidence_weights.inc says what
/// they were fitted on, and by which command.
double confidence(const Evidence& evidence, HypothesisSource source);

/// The most that the features on its surface can make of the confidence of a hypothesis whose depth and colours are
/// compared.
double confidenceWithFeatures(const VerifiedHypothesis& hypothesis);

/// The most that the confidence of a hypothesis can still become, by the evidence of the levels that it has reached.
double maxConfidence(const VerifiedHypothesis& hypothesis);

/// What a hypothesis explains, weighted by how little doubt is left: pixels alone would prefer a pose rotated to where
/// the texture repeats but for a detail, as illumination and noise outweigh the detail.
double explanatoryStrength(const Evidence& evidence, double confidence);

}  // namespace recognition
