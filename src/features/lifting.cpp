#include "features/lifting.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <stdexcept>

#include "core/depth_noise.h"

namespace recognition {
namespace {

constexpr double kNoiseSigmas = 4.0;  // a gap in sorted depths that noise hardly makes
constexpr int kMinRadius = 3;
constexpr int kMaxRadius = 6;
constexpr int kMaxWindow =
    32;  // largest radius that the weights have room for; LiftingParameters::max_hole is at most 20
constexpr int kMinPixels = 3;  // of a surface; fewer are flying pixels
constexpr double kRidge = 1e-3;

struct DepthSample {
  float z = 0.0f;
  float du = 0.0f;  // pixels from the keypoint
  float dv = 0.0f;
  float weight = 0.0f;
};

struct Surface {
  size_t begin = 0;
  size_t end = 0;
  double weight = 0.0;
  double distance = 0.0;  // pixels to its nearest sample
};

/// Fills `samples`, whose memory is kept.
void samplesAround(const cv::Mat& depth, float u, float v, int radius, std::vector<DepthSample>* samples) {
  samples->clear();
  const int u0 = cvRound(u), v0 = cvRound(v);
  const float sigma = 0.5f * static_cast<float>(radius);
  const float scale = -1.0f / (2.0f * sigma * sigma);
  std::array<float, 2 * kMaxWindow + 1> across;  // the weights are separable
  for (int i = -radius; i <= radius; ++i) {
    const float du = static_cast<float>(u0 + i) - u;
    across[static_cast<size_t>(i + radius)] = std::exp(scale * du * du);
  }
  for (int y = std::max(0, v0 - radius); y <= std::min(depth.rows - 1, v0 + radius); ++y) {
    const float* row = depth.ptr<float>(y);
    const float dv = static_cast<float>(y) - v, along = std::exp(scale * dv * dv);
    for (int x = std::max(0, u0 - radius); x <= std::min(depth.cols - 1, u0 + radius); ++x) {
      if (!(row[x] > 0.0f)) continue;
      samples->push_back({row[x], static_cast<float>(x) - u, dv, along * across[static_cast<size_t>(x - u0 + radius)]});
    }
  }
}

Surface surfaceOf(const std::vector<DepthSample>& samples, size_t begin, size_t end) {
  Surface surface{begin, end, 0.0, 1e9};
  for (size_t i = begin; i < end; ++i) {
    const DepthSample& s = samples[i];
    surface.weight += s.weight;
    surface.distance = std::min(surface.distance, static_cast<double>(s.du * s.du + s.dv * s.dv));
  }
  surface.distance = std::sqrt(surface.distance);
  return surface;
}

/// No jump fits between the nearest and the farthest: the usual case, without sorting.
bool isOneSurface(const std::vector<DepthSample>& samples, double jump) {
  float nearest = samples.front().z, farthest = nearest;
  for (const DepthSample& s : samples) {
    nearest = std::min(nearest, s.z);
    farthest = std::max(farthest, s.z);
  }
  return farthest - nearest <= std::max(jump, kNoiseSigmas * depthSigma(nearest));
}

// Nearest first.
std::vector<Surface> splitAtJumps(const std::vector<DepthSample>& samples, double jump) {
  std::vector<Surface> surfaces;
  size_t begin = 0;
  for (size_t i = 1; i <= samples.size(); ++i) {
    const bool parted = i == samples.size() ||
                        samples[i].z - samples[i - 1].z > std::max(jump, kNoiseSigmas * depthSigma(samples[i - 1].z));
    if (!parted) continue;
    if (i - begin >= kMinPixels) surfaces.push_back(surfaceOf(samples, begin, i));
    begin = i;
  }
  return surfaces;
}

// Weighted least squares for 1/z = a + b du + c dv; 1/a is the depth at the keypoint.
DepthPlane planeOf(const std::vector<DepthSample>& samples, const Surface& surface) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (size_t i = surface.begin; i < surface.end; ++i) {
    const DepthSample& s = samples[i];
    const Eigen::Vector3d row(1.0, s.du, s.dv);
    normal += s.weight * row * row.transpose();
    right += s.weight / s.z * row;
  }
  normal.diagonal().tail<2>().array() += kRidge * surface.weight;  // keeps a single row or column of pixels solvable
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  const double inverse = fit.x();
  const auto first = samples.begin() + static_cast<std::ptrdiff_t>(surface.begin);
  const auto ends = std::minmax_element(first, samples.begin() + static_cast<std::ptrdiff_t>(surface.end),
                                        [](const DepthSample& a, const DepthSample& b) { return a.z < b.z; });
  const double nearest = ends.first->z, farthest = ends.second->z;
  const double z = inverse > 0.0 ? std::clamp(1.0 / inverse, nearest, farthest) : farthest;
  return {static_cast<float>(z), static_cast<float>(fit.y()), static_cast<float>(fit.z())};
}

/// Unit, towards the camera: a plane n X = d has 1 / z = n ray / d.
Eigen::Vector3f normalOf(const DepthPlane& plane, const Eigen::Vector3f& point, const CameraModel& camera) {
  const float by_x = plane.inverse_by_u * static_cast<float>(camera.fx);
  const float by_y = plane.inverse_by_v * static_cast<float>(camera.fy);
  const Eigen::Vector3f ray = point / point.z();
  return -Eigen::Vector3f(by_x, by_y, 1.0f / plane.z - by_x * ray.x() - by_y * ray.y()).normalized();
}

ImageFeatures select(const ImageFeatures& features, const std::vector<int>& members) {
  ImageFeatures selected;
  selected.type = features.type;
  selected.descriptors.create(static_cast<int>(members.size()), descriptorLength(features.type), CV_32FC1);
  selected.keypoints.reserve(members.size());
  for (size_t k = 0; k < members.size(); ++k) {
    selected.keypoints.push_back(features.keypoints[static_cast<size_t>(members[k])]);
    features.descriptors.row(members[k]).copyTo(selected.descriptors.row(static_cast<int>(k)));
  }
  return selected;
}

}  // namespace

DepthPlane surfaceAt(const cv::Mat& depth, float u, float v, int radius, const LiftingParameters& parameters) {
  thread_local std::vector<DepthSample> samples;
  samplesAround(depth, u, v, radius, &samples);
  if (samples.size() >= kMinPixels && isOneSurface(samples, parameters.jump)) {
    const Surface all = surfaceOf(samples, 0, samples.size());
    return all.distance > parameters.max_hole + 0.5 ? DepthPlane() : planeOf(samples, all);
  }
  std::sort(samples.begin(), samples.end(), [](const DepthSample& a, const DepthSample& b) { return a.z < b.z; });
  std::vector<Surface> surfaces = splitAtJumps(samples, parameters.jump);
  const auto far = [&](const Surface& s) { return s.distance > parameters.max_hole + 0.5; };
  surfaces.erase(std::remove_if(surfaces.begin(), surfaces.end(), far), surfaces.end());
  double total = 0.0;
  for (const Surface& surface : surfaces) total += surface.weight;
  for (const Surface& surface : surfaces)
    if (surface.weight >= parameters.foreground * total) return planeOf(samples, surface);
  return surfaces.empty() ? DepthPlane() : planeOf(samples, surfaces.back());
}

SceneFeatures liftFeatures(const ImageFeatures& features, const cv::Mat& depth, const CameraModel& depth_camera,
                           int color_per_depth, const LiftingParameters& parameters) {
  if (depth.type() != CV_32FC1) throw std::invalid_argument("lifting: depth is not CV_32FC1 metres");
  if (color_per_depth < 1)
    throw std::invalid_argument("lifting: colour per depth pixel is " + std::to_string(color_per_depth));
  const float k = static_cast<float>(color_per_depth);
  std::vector<Eigen::Vector3f> places(features.keypoints.size()), normals(places);
  cv::parallel_for_(cv::Range(0, features.count()), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const Keypoint& keypoint = features.keypoints[i];
      const float u = (keypoint.x + 0.5f) / k - 0.5f, v = (keypoint.y + 0.5f) / k - 0.5f;
      const int radius =
          std::clamp(cvRound(0.25f * keypoint.size / k), std::max(kMinRadius, parameters.max_hole), kMaxRadius);
      const DepthPlane plane = surfaceAt(depth, u, v, radius, parameters);
      places[i] = depth_camera.unproject(u, v, plane.z).cast<float>();
      normals[i] = plane.z > 0.0f ? normalOf(plane, places[i], depth_camera) : Eigen::Vector3f::Zero();
    }
  });

  SceneFeatures scene;
  std::vector<int> with, without;
  for (int i = 0; i < features.count(); ++i) (places[i].z() > 0.0f ? with : without).push_back(i);
  scene.image = select(features, with);
  scene.without_depth = select(features, without);
  for (const int i : with) {
    scene.points.push_back(places[i]);
    scene.normals.push_back(normals[i]);
  }
  scene.focal_length = k * static_cast<float>(depth_camera.fx);
  return scene;
}

}  // namespace recognition
