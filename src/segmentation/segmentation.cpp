#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/core/frame.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>
#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

/// Sums over the 3D points of a component.
struct Moments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  int left = 0, top = 0, right = -1, bottom = -1;
};

std::vector<Moments> momentsOf(const cv::Mat& depth, const CameraModel& camera, const cv::Mat& labels, int count) {
  std::vector<Moments> moments(static_cast<size_t>(count));
  const double inverse_fx = 1.0 / camera.fx;
  for (int v = 0; v < labels.rows; ++v) {
    const int* row = labels.ptr<int>(v);
    const float* z_row = depth.ptr<float>(v);
    const double ray_y = (v - camera.cy) / camera.fy;
    for (int u = 0; u < labels.cols;) {
      const int label = row[u];
      if (label <= kUnlabelled) {
        ++u;
        continue;
      }
      Moments& m = moments[static_cast<size_t>(label)];
      if (m.n == 0) m.left = u, m.right = u, m.top = v;
      m.bottom = v;
      m.left = std::min(m.left, u);
      double z_sum = 0.0, zz = 0.0, xz = 0.0, xzz = 0.0, xxzz = 0.0;  // x, y here: of the ray with z = 1
      for (; u < labels.cols && row[u] == label; ++u) {
        const double z = z_row[u], ray_x = (u - camera.cx) * inverse_fx, square = z * z;
        m.n += 1.0, z_sum += z, zz += square;
        xz += ray_x * z, xzz += ray_x * square, xxzz += ray_x * ray_x * square;
      }
      m.x += xz, m.y += ray_y * z_sum, m.z += z_sum;
      m.xx += xxzz, m.xy += ray_y * xzz, m.xz += xzz, m.yy += ray_y * ray_y * zz, m.yz += ray_y * zz, m.zz += zz;
      m.right = std::max(m.right, u - 1);
    }
  }
  return moments;
}

Patch patchOf(const Moments& m, int label) {
  const Eigen::Vector3d mean = Eigen::Vector3d(m.x, m.y, m.z) / m.n;
  Eigen::Matrix3d square;
  square << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(square / m.n - mean * mean.transpose());
  Patch patch;
  patch.label = label;
  patch.pixels = static_cast<int>(m.n);
  patch.box = cv::Rect(m.left, m.top, m.right - m.left + 1, m.bottom - m.top + 1);
  patch.centroid = mean.cast<float>();
  patch.eigenvalues = solver.eigenvalues().cwiseMax(0.0).cast<float>();
  patch.axes = solver.eigenvectors().cast<float>();
  return patch;
}

}  // namespace

void requireSameSize(const Segmentation& segmentation, const cv::Mat& depth) {
  for (const cv::Mat* image : {&segmentation.labels, &segmentation.edges})
    if (image->size() != depth.size())
      throw std::invalid_argument("segmentation: labels and edges of " + std::to_string(image->cols) + "x" +
                                  std::to_string(image->rows) + ", the depth image has " + std::to_string(depth.cols) +
                                  "x" + std::to_string(depth.rows));
}

std::vector<Patch> describePatches(const cv::Mat& depth, const CameraModel& camera, const cv::Mat& labels, int count,
                                   int min_pixels) {
  const std::vector<Moments> moments = momentsOf(depth, camera, labels, count);
  std::vector<Patch> patches;
  for (int label = 1; label < count; ++label)
    if (moments[static_cast<size_t>(label)].n >= min_pixels)
      patches.push_back(patchOf(moments[static_cast<size_t>(label)], label));
  return patches;
}

cv::Mat toColorSize(const cv::Mat& mask, cv::Size color_size, int color_per_depth) {
  cv::Mat whole(color_size, CV_8UC1, cv::Scalar(0));
  const cv::Mat within = mask(cv::Rect({}, mask.size()) & cv::Rect({}, color_size / color_per_depth));
  cv::Mat covered = whole(cv::Rect({}, within.size() * color_per_depth));
  cv::resize(within, covered, covered.size(), 0, 0, cv::INTER_NEAREST);
  return whole;
}

cv::Mat regionMask(const Segmentation& segmentation, cv::Size color_size, int color_per_depth, int margin) {
  if (color_per_depth < 1 || margin < 0) throw std::invalid_argument("region mask: negative margin or scale");
  const cv::Size covered = segmentation.labels.size() * color_per_depth;
  if (color_size.width < covered.width || color_size.height < covered.height)
    throw std::invalid_argument("region mask: colour image is smaller than what depth covers");
  cv::Mat regions = segmentation.labels > kUnlabelled;
  if (margin > 0)
    cv::dilate(regions, regions, cv::getStructuringElement(cv::MORPH_RECT, {2 * margin + 1, 2 * margin + 1}));
  return toColorSize(regions, color_size, color_per_depth);
}

}  // namespace recognition
