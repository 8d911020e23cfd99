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
/// Fitted on simulated table tops by scripts/fit_confidence.py: the 35 household objects in 60 frames (seed 101, colour 1280x1024) and 36
/// (seed 11, 640x480), and 15 other objects in 60 (seed 102, 1280x1024). To fit again: `simulate challenge`, `evaluate`, and the script on
/// the frames.jsonl of several sets.
double confidence(const Evidence& evidence);

}  // namespace rgbd_recognition
