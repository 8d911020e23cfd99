#pragma once

#include <array>

#include "verification/evidence.h"

namespace recognition {

/// What the confidence is computed from, each value of order one; see confidenceInputs() for their order.
using ConfidenceInputs = std::array<double, 7>;

ConfidenceInputs confidenceInputs(const Evidence& evidence);

/// Probability that a hypothesis is right: logistic model over confidenceInputs(), one for hypotheses with a consensus
/// set and their symmetric alternatives and one for proposals, whose inliers are the features of the texture that match at their
/// places (matchTexture()). The latter was fitted on those of single correspondences; by shape, fewer are right than it
/// says.
///
/// Fitted on simulated table tops by scripts/fit_confidence.py (which says how): the 35 household objects in 160 frames
/// (seeds 201, 301, 401) and 15 other objects in 170 (202, 402 and one set more), colour 1280x1024.
double confidence(const Evidence& evidence, HypothesisSource source);

/// The most that the confidence of a hypothesis can still become, by the evidence of the levels that it has reached.
double maxConfidence(const VerifiedHypothesis& hypothesis);

}  // namespace recognition
