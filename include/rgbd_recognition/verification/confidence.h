#pragma once

#include <array>

#include "rgbd_recognition/verification/evidence.h"

namespace rgbd_recognition {

/// What the confidence is computed from, each value of order one; see confidenceInputs() for their order.
using ConfidenceInputs = std::array<double, 6>;

ConfidenceInputs confidenceInputs(const Evidence& evidence);

/// Names of the inputs, in order: columns of a table to fit from.
const std::array<const char*, 6>& confidenceInputNames();

/// Probability that a hypothesis is right: logistic model over confidenceInputs().
///
/// Fitted on simulated table tops by scripts/fit_confidence.py: 60 frames with the 35 household objects (seed 101) and 60 with
/// 15 others (seed 102), colour 1280x1024; 1723 hypotheses, 212 of them right. To fit again: `simulate challenge`, `evaluate`, and the
/// script on the frames.jsonl of several sets.
double confidence(const Evidence& evidence);

}  // namespace rgbd_recognition
