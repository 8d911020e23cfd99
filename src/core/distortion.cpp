#include "rgbd_recognition/core/distortion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

bool isEquidistant(const std::string& model) { return model == "equidistant" || model == "fisheye"; }

Eigen::Vector2d applyEquidistant(const std::vector<double>& k, const Eigen::Vector2d& p) {
  const double r = p.norm();
  if (r < 1e-9) return p;
  const double angle = std::atan(r), a2 = angle * angle;
  double sum = 1.0, power = 1.0;
  for (size_t i = 0; i < 4 && i < k.size(); ++i) sum += k[i] * (power *= a2);
  return p * (angle * sum / r);
}

Eigen::Vector2d applyBrown(const std::vector<double>& coefficients, const Eigen::Vector2d& p) {
  double c[12] = {};
  std::copy_n(coefficients.begin(), std::min<size_t>(12, coefficients.size()), c);
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm(), r4 = r2 * r2, r6 = r4 * r2;
  const double radial = (1.0 + c[0] * r2 + c[1] * r4 + c[4] * r6) / (1.0 + c[5] * r2 + c[6] * r4 + c[7] * r6);
  return {x * radial + 2.0 * c[2] * x * y + c[3] * (r2 + 2.0 * x * x) + c[8] * r2 + c[9] * r4,
          y * radial + c[2] * (r2 + 2.0 * y * y) + 2.0 * c[3] * x * y + c[10] * r2 + c[11] * r4};
}

cv::Mat undone(const cv::Mat& image, const Distortion& distortion, const CameraModel& from, const CameraModel& to,
               int interpolation) {
  cv::Mat map(image.size(), CV_32FC2), result;
  cv::parallel_for_(cv::Range(0, image.rows), [&](const cv::Range& rows) {
    for (int v = rows.start; v < rows.end; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector2d seen = distortion.apply({(u - to.cx) / to.fx, (v - to.cy) / to.fy});
        map.at<cv::Vec2f>(v, u) = {static_cast<float>(from.fx * seen.x() + from.cx),
                                   static_cast<float>(from.fy * seen.y() + from.cy)};
      }
  });
  cv::remap(image, result, map, cv::noArray(), interpolation, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return result;
}

}  // namespace

bool Distortion::isThere() const {
  return std::any_of(coefficients.begin(), coefficients.end(), [](double value) { return value != 0.0; });
}

void Distortion::validate() const {
  if (!isThere()) return;
  const size_t count = coefficients.size();
  const bool brown = model == "plumb_bob" || model == "rational_polynomial" || model.empty();
  if (!brown && !isEquidistant(model))
    throw std::invalid_argument(
        "the distortion model '" + model +
        "' is not known (plumb_bob, rational_polynomial and equidistant are); rectify the images");
  const bool tilted = count == 14 && (coefficients[12] != 0.0 || coefficients[13] != 0.0);
  const bool fits =
      brown ? count == 4 || count == 5 || count == 8 || count == 12 || (count == 14 && !tilted) : count == 4;
  if (!fits)
    throw std::invalid_argument("the distortion model '" + model + "' has " + std::to_string(count) +
                                " coefficients, which is not read; rectify the images");
  for (const double value : coefficients)
    if (!std::isfinite(value)) throw std::invalid_argument("the distortion has a coefficient that is not finite");
}

Eigen::Vector2d Distortion::apply(const Eigen::Vector2d& ideal) const {
  return isEquidistant(model) ? applyEquidistant(coefficients, ideal) : applyBrown(coefficients, ideal);
}

RgbdFrame undistorted(const RgbdFrame& frame, const Distortion& distortion, const CameraModel& rectified,
                      bool depth_is_rectified) {
  distortion.validate();
  RgbdFrame result = frame;
  result.color_camera = rectified;
  result.color = undone(frame.color, distortion, frame.color_camera, rectified, cv::INTER_LINEAR);
  if (!depth_is_rectified)
    result.depth = undone(frame.depth, distortion, frame.depthCamera(), result.depthCamera(), cv::INTER_NEAREST);
  return result;
}

}  // namespace recognition
