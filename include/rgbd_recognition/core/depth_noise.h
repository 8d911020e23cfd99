#pragma once

namespace rgbd_recognition {

/// Axial noise (standard deviation, metres) of a Kinect-like sensor at depth z (metres): (m / (f b)) sigma_d z^2, with
/// m / (f b) = 2.85e-3 1/m, sigma_d = 0.5 disparity units (Khoshelham and Elberink, Sensors 2012, eq. 10 and Sec. 4).
/// Never below `floor`: calibration and quantisation remain when z is small.
inline double depthSigma(double z, double floor = 0.0005) {
  const double sigma = 1.425e-3 * z * z;
  return sigma > floor ? sigma : floor;
}

}  // namespace rgbd_recognition
