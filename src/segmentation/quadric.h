#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace recognition {

/// A quadric surface as a depth camera sees it: 1/z = q0 + q1 s + q2 t + q3 s^2 + q4 s t + q5 t^2 with s = (u - u0) /
/// scale, t = (v - v0) / scale.
///
/// Multiplied by z^2 this is a homogeneous quadratic equation in (x, y, z): a quadric in 3D. Deviation from the paper's
/// general quadric: those through the optical centre only, which are functions of the pixel. Planes are among them, the
/// fit is linear least squares in the sensor's own unit of noise, and a pixel is tested with one evaluation.
struct InverseDepthQuadric {
  std::array<float, 6> q{};
  float u0 = 0.0f;
  float v0 = 0.0f;
  float inverse_scale = 1.0f;

  /// 1/z at pixel (u, v).
  float at(int u, int v) const {
    const float s = (static_cast<float>(u) - u0) * inverse_scale;
    const float t = (static_cast<float>(v) - v0) * inverse_scale;
    return q[0] + s * (q[1] + s * q[3] + t * q[4]) + t * (q[2] + t * q[5]);
  }
};

/// Least-squares fit to the pixels of `box` whose label (CV_32SC1) is `label`; `inverse` CV_32FC1 1/z. Plane or
/// quadric, whichever has the lower AICc, as for scan-lines (eq. 6-7) with the sensor's standard deviation. False if
/// the pixels do not determine a plane.
bool fitQuadric(const cv::Mat& inverse, const cv::Mat& labels, int label, const cv::Rect& box,
                InverseDepthQuadric* quadric);

}  // namespace recognition
