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
/// Fitted on simulated table tops (90 frames of 222 instances, other seeds than the test sets'): hypotheses of the
/// generator, true poses disturbed by about 8 mm and 4 degrees with 3 to 16 features, and wrong ones at the places of
/// true ones (other objects, look-alikes, other rotations) that were given features that agree by chance; weights 1,
/// 0.3 and 0.1 (look-alikes, which the choice among hypotheses decides). To fit again: run verification on such
/// hypotheses with test_alternatives off, take confidenceInputs() of each and whether its pose is right (within 2 cm
/// and 10 degrees), and fit a logistic regression with an L2 penalty of 2 on standardised inputs.
double confidence(const Evidence& evidence);

}  // namespace rgbd_recognition
