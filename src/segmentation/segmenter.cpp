#include "segmentation/segmenter.h"

#include <chrono>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "segmentation/image_pool.h"
#include "core/simd.h"
#include "segmentation/edge_detector.h"
#include "segmentation/large_planes.h"
#include "segmentation/patch_builder.h"

namespace recognition {
namespace {

using Clock = std::chrono::steady_clock;

SegmentationParameters validated(const SegmentationParameters& parameters) {
  parameters.validate();
  return parameters;
}

double secondsSince(Clock::time_point* start) {
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - *start).count();
  *start = now;
  return seconds;
}

/// 1/z; 0 for everything that is no depth (0, negative, NaN, Inf).
RGBD_SIMD_CLONES void invertRow(const float* depth, float* inverse, int n) {
  for (int i = 0; i < n; ++i) inverse[i] = depth[i] > 0.0f ? 1.0f / depth[i] : 0.0f;
}

/// The depth where it is valid, else 0.
RGBD_SIMD_CLONES void cleanRow(const float* depth, const float* inverse, float* clean, int n) {
  for (int i = 0; i < n; ++i) clean[i] = inverse[i] > 0.0f ? depth[i] : 0.0f;
}

RGBD_SIMD_CLONES void markValid(const float* inverse, std::uint8_t* smooth, int n) {
  for (int i = 0; i < n; ++i) smooth[i] = inverse[i] > 0.0f ? 255 : 0;
}

RGBD_SIMD_CLONES void clearInvalid(const float* inverse, std::uint8_t* smooth, int n) {
  for (int i = 0; i < n; ++i) smooth[i] = inverse[i] > 0.0f ? smooth[i] : 0;
}

RGBD_SIMD_CLONES void clearMarked(const std::uint8_t* marks, std::uint8_t* smooth, int n) {
  for (int i = 0; i < n; ++i) smooth[i] = marks[i] ? 0 : smooth[i];
}

RGBD_SIMD_CLONES void labelPlanes(const std::uint8_t* planes, int* labels, int n) {
  for (int i = 0; i < n; ++i) labels[i] = planes[i] ? kLargePlane : labels[i];
}

cv::Mat squareKernel(int size) { return cv::getStructuringElement(cv::MORPH_RECT, {size, size}); }

}  // namespace

class Segmenter::Impl {
 public:
  Impl(const SegmentationParameters& parameters, const Extents& limits)
      : parameters_(validated(parameters)),
        limits_(limits),
        edge_detector_(parameters),
        plane_finder_(parameters),
        patch_builder_(parameters, limits),
        erosion_(squareKernel(parameters.erosion)),
        dilation_(squareKernel(parameters.dilation)) {}

  Segmentation segment(const cv::Mat& depth, const CameraModel& camera) {
    check(depth, camera);
    Segmentation result;
    result.edges = pool_.get(depth.size(), CV_8UC1);
    result.labels = pool_.get(depth.size(), CV_32SC1);
    Clock::time_point lap = Clock::now();
    inverse_.create(depth.size(), CV_32FC1);
    for (int v = 0; v < depth.rows; ++v) invertRow(depth.ptr<float>(v), inverse_.ptr<float>(v), depth.cols);
    edge_detector_.detect(parameters_.noise_model == NoiseModel::kSensor ? inverse_ : cleanDepth(depth), camera,
                          &result.edges);
    times_.edges = secondsSince(&lap);

    findSmoothPixels(result.edges);
    times_.components = secondsSince(&lap);

    removeLargePlanes(camera);
    times_.planes = secondsSince(&lap);

    if (!patch_builder_.findComponents(depth, smooth_, camera, &result.labels, &too_large_) &&
        removeHiddenPlanes(camera))
      patch_builder_.findComponents(depth, smooth_, camera, &result.labels, &too_large_);
    times_.components += secondsSince(&lap);

    patch_builder_.expand(inverse_, planes_, &result.labels);
    result.patches = patch_builder_.describe(depth, camera, result.labels);
    for (int v = 0; v < depth.rows; ++v) labelPlanes(planes_.ptr(v), result.labels.ptr<int>(v), depth.cols);
    times_.expansion = secondsSince(&lap);
    return result;
  }

  const SegmentationTimes& times() const { return times_; }

 private:
  static void check(const cv::Mat& depth, const CameraModel& camera) {
    camera.validate();
    if (depth.type() != CV_32FC1 || depth.empty())
      throw std::invalid_argument("segmentation: depth is no CV_32FC1 image");
    if (depth.cols != camera.width || depth.rows != camera.height)
      throw std::invalid_argument("segmentation: depth is " + std::to_string(depth.cols) + "x" +
                                  std::to_string(depth.rows) + ", its camera " + std::to_string(camera.width) + "x" +
                                  std::to_string(camera.height));
  }

  const cv::Mat& cleanDepth(const cv::Mat& depth) {
    clean_.create(depth.size(), CV_32FC1);
    for (int v = 0; v < depth.rows; ++v)
      cleanRow(depth.ptr<float>(v), inverse_.ptr<float>(v), clean_.ptr<float>(v), depth.cols);
    return clean_;
  }

  /// Erosion and dilation of Sec. IV-A on the pixels without edge, so that edges become closed boundaries. Invalid
  /// pixels count as edges, too, but not where a hole is narrower than the erosion's kernel: those would tear a patch
  /// that they do not interrupt.
  void findSmoothPixels(const cv::Mat& edges) {
    smooth_.create(edges.size(), CV_8UC1);
    for (int v = 0; v < edges.rows; ++v) markValid(inverse_.ptr<float>(v), smooth_.ptr(v), edges.cols);
    cv::morphologyEx(smooth_, smooth_, cv::MORPH_CLOSE, erosion_);
    for (int v = 0; v < edges.rows; ++v) clearMarked(edges.ptr(v), smooth_.ptr(v), edges.cols);
    cv::erode(smooth_, eroded_, erosion_);
    cv::dilate(eroded_, smooth_, dilation_);
    for (int v = 0; v < edges.rows; ++v) clearInvalid(inverse_.ptr<float>(v), smooth_.ptr(v), edges.cols);
  }

  void removeLargePlanes(const CameraModel& camera) {
    if (limits_.sigma_max <= 0.0) {
      planes_.create(smooth_.size(), CV_8UC1);
      planes_.setTo(0);
      return;
    }
    plane_finder_.find(inverse_, smooth_, camera, parameters_.plane_size_margin * limits_.sigma_max, &planes_);
    for (int v = 0; v < smooth_.rows; ++v) clearMarked(planes_.ptr(v), smooth_.ptr(v), smooth_.cols);
  }

  /// A deviation from the paper, which drops a component larger than any object: its planes alone are removed, though
  /// objects' faces may be as large, so that what stands on them is not lost with them. False if it has none.
  bool removeHiddenPlanes(const CameraModel& camera) {
    if (parameters_.hidden_plane <= 0.0) return false;
    const double largest = parameters_.hidden_plane * parameters_.plane_size_margin * limits_.sigma_max;
    if (plane_finder_.find(inverse_, too_large_, camera, largest, &hidden_planes_).empty()) return false;
    cv::bitwise_or(planes_, hidden_planes_, planes_);
    for (int v = 0; v < smooth_.rows; ++v) clearMarked(planes_.ptr(v), smooth_.ptr(v), smooth_.cols);
    return true;
  }

  const SegmentationParameters parameters_;
  const Extents limits_;
  EdgeDetector edge_detector_;
  LargePlaneFinder plane_finder_;
  PatchBuilder patch_builder_;
  const cv::Mat erosion_, dilation_;
  ImagePool pool_;
  cv::Mat inverse_;                    ///< CV_32FC1 1/z, 0 invalid
  cv::Mat clean_;                      ///< CV_32FC1 metres; only for NoiseModel::kConstant
  cv::Mat smooth_, eroded_;            ///< CV_8UC1
  cv::Mat planes_;                     ///< CV_8UC1, 255 on large planes
  cv::Mat too_large_, hidden_planes_;  ///< CV_8UC1, 255 on components larger than any object, and on their planes
  SegmentationTimes times_;
};

Segmenter::Segmenter(const SegmentationParameters& parameters, const Extents& limits)
    : impl_(std::make_unique<Impl>(parameters, limits)) {}
Segmenter::~Segmenter() = default;
Segmentation Segmenter::segment(const cv::Mat& depth, const CameraModel& camera) {
  return impl_->segment(depth, camera);
}
const SegmentationTimes& Segmenter::times() const { return impl_->times(); }

}  // namespace recognition
