#pragma once

#include <array>

#include "rgbd_recognition/verification/evidence.h"

namespace rgbd_recognition {

/// What the confidence is computed from, each value of order one; see confidenceInputs() for their order.
using ConfidenceInputs = std::array<double, 9>;

ConfidenceInputs confidenceInputs(const ConsistencyScores& scores, const Evidence& evidence);

/// Names of the inputs, in order: columns of a table to fit from.
const std::array<const char*, 9>& confidenceInputNames();

/// Probability that a hypothesis is right: logistic model over confidenceInputs().
double confidence(const ConsistencyScores& scores, const Evidence& evidence);

}  // namespace rgbd_recognition
