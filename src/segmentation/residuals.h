#pragma once

#include <cstdint>

#include "segmentation/polynomial_fit.h"

namespace recognition {

/// Bits of |z[i] - polynomial(first + i)| for i in 0..n (as integers they are ordered as the numbers are) into
/// `residuals`; the largest is returned.
std::int32_t residualBits(const float* z, int n, int first, const Polynomial& polynomial, std::int32_t* residuals);

/// The number as residualBits() writes it.
std::int32_t bitsOf(float value);

}  // namespace recognition
