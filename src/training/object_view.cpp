#include "training/object_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <opencv2/imgproc.hpp>

#include "core/depth_noise.h"

namespace recognition {
namespace {

constexpr int kNormalPixels = 3;          // pixels over which a normal is measured
constexpr float kNormalJump = 0.012f;     // metres between pixels of one surface
constexpr float kMinSightCosine = 0.25f;  // to the line of sight; steeper surface is measured badly
constexpr int kRim = 1;                   // pixels at the mask's rim mix object and background
constexpr int kEdge = 4;                  // pixels at the rim to which a sensor's window may spread the object's depth

// Plane through the neighbourhood by least squares; false if it has too few points.
bool fitNormal(const ObjectView& view, int u, int v, Eigen::Vector3f& centre, Eigen::Vector3f& normal) {
  const float z = view.depth.at<float>(v, u);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  int count = 0;
  for (int y = std::max(0, v - kNormalPixels); y <= std::min(view.depth.rows - 1, v + kNormalPixels); ++y)
    for (int x = std::max(0, u - kNormalPixels); x <= std::min(view.depth.cols - 1, u + kNormalPixels); ++x) {
      const float other = view.depth.at<float>(y, x);
      if (!(other > 0.0f) || std::abs(other - z) > kNormalJump || view.mask.at<uchar>(y, x) == 0) continue;
      const Eigen::Vector3d p = view.depth_camera.unproject(x, y, other);
      sum += p;
      squares += p * p.transpose();
      ++count;
    }
  if (count < 12) return false;
  const Eigen::Vector3d mean = sum / count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(squares / count - mean * mean.transpose());
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  normal = (n.dot(mean) > 0.0 ? -n : n).cast<float>();
  // The pixel's own ray on the fitted plane: the noise of one pixel is averaged away, its place is kept.
  const Eigen::Vector3d ray = view.depth_camera.unproject(u, v, 1.0);
  const double slope = ray.dot(n);
  if (std::abs(slope) < 1e-3) return false;
  centre = (ray * (mean.dot(n) / slope)).cast<float>();
  return std::abs(centre.z() - z) < kNormalJump;
}

}  // namespace

std::optional<PointInView> ObjectView::find(const Eigen::Vector3f& point) const {
  const Eigen::Vector3d p = camera_from_world * point.cast<double>();
  if (p.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d in_depth = depth_camera.project(p);
  const cv::Point pixel(cvRound(in_depth.x()), cvRound(in_depth.y()));
  if (!cv::Rect({}, depth.size()).contains(pixel) || !(depth.at<float>(pixel) > 0.0f)) return std::nullopt;
  return PointInView{p, pixel, depth.at<float>(pixel) - p.z()};
}

ObjectView makeObjectView(const RgbdFrame& frame) {
  frame.validate();
  ObjectView view;
  if (frame.color_order == ColorOrder::kRgb)
    view.color = frame.color.clone();
  else
    cv::cvtColor(frame.color, view.color, cv::COLOR_BGR2RGB);
  view.color_camera = frame.color_camera;
  view.depth_camera = frame.depthCamera();
  view.color_per_depth = frame.colorPerDepthPixel();
  view.depth = depthInMetres(frame.depth).clone();
  return view;
}

cv::Mat nearestDepthAround(const cv::Mat& depth) {
  cv::Mat nearest = depth.clone();
  const cv::Mat invalid = ~(depth > 0.0f);
  nearest.setTo(std::numeric_limits<float>::max(), invalid);
  cv::erode(nearest, nearest, cv::Mat());
  nearest.setTo(0.0f, invalid);
  return nearest;
}

std::vector<Surfel> measureSurface(const ObjectView& view, int stride) {
  cv::Mat inner, innermost;
  cv::erode(view.mask, inner, cv::Mat(), cv::Point(-1, -1), kRim, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::erode(view.mask, innermost, cv::Mat(), cv::Point(-1, -1), kEdge, cv::BORDER_CONSTANT, cv::Scalar(0));
  std::vector<Surfel> surfels;
  for (int v = 0; v < inner.rows; v += stride)
    for (int u = 0; u < inner.cols; u += stride) {
      if (inner.at<uchar>(v, u) == 0 || !(view.depth.at<float>(v, u) > 0.0f)) continue;
      Surfel surfel;
      if (!fitNormal(view, u, v, surfel.position, surfel.normal)) continue;
      const float cosine = -surfel.normal.dot(surfel.position.normalized());
      if (cosine < kMinSightCosine) continue;
      const auto sigma = static_cast<float>(depthSigma(surfel.position.z()));
      surfel.inner = innermost.at<uchar>(v, u) > 0;
      surfel.weight = cosine * cosine * 1e-6f / (sigma * sigma);
      const int k = view.color_per_depth;
      const cv::Rect pixels = cv::Rect(u * k, v * k, k, k) & cv::Rect({}, view.color.size());
      const cv::Scalar mean = cv::mean(view.color(pixels));
      surfel.rgb = cv::Vec3b(cv::saturate_cast<uchar>(mean[0]), cv::saturate_cast<uchar>(mean[1]),
                             cv::saturate_cast<uchar>(mean[2]));
      surfels.push_back(surfel);
    }
  return surfels;
}

}  // namespace recognition
