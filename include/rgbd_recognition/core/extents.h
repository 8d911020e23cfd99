#pragma once

namespace recognition {

/// Sigma, eq. (4): sizes of the three-sigma ellipsoid that approximates an object, metres.
struct Extents {
  double sigma_min = 0.0;
  double sigma_max = 0.0;
  double sigma_d = 0.0;  ///< diameter of gyration about the main axis
};

}  // namespace recognition
