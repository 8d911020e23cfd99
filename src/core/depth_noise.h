#pragma once

namespace recognition {

constexpr double kDepthNoise = 1.425e-3;   ///< 1/m: deviation over the square of the depth
constexpr double kMinDepthNoise = 0.0005;  ///< metres: calibration and quantisation remain when z is small

/// Axial noise (standard deviation, metres) of a Kinect-like sensor at depth z (metres): (m / (f b)) sigma_d z^2, with
/// m / (f b) = 2.85e-3 1/m, sigma_d = 0.5 disparity units (Khoshelham and Elberink, Sensors 2012, eq. 10 and Sec. 4).
/// Never below `floor`.
inline double depthSigma(double z, double floor = kMinDepthNoise) {
  const double sigma = kDepthNoise * z * z;
  return sigma > floor ? sigma : floor;
}

}  // namespace recognition
