#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "core/angles.h"
#include "features/extractors.h"
#include "features/feature_extractor.h"

#define RGBD_OPENCV_HAS_SIFT (CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 4))

namespace recognition {
namespace {

void normalizeRow(float* row, int n, bool root) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += root ? row[i] : double(row[i]) * row[i];
  if (sum <= 0.0) return;
  const float scale = static_cast<float>(1.0 / (root ? sum : std::sqrt(sum)));
  for (int i = 0; i < n; ++i) row[i] = root ? std::sqrt(row[i] * scale) : row[i] * scale;
}

Keypoint fromOpenCv(const cv::KeyPoint& point) {
  Keypoint keypoint;
  keypoint.x = point.pt.x;
  keypoint.y = point.pt.y;
  keypoint.size = point.size;
  keypoint.angle = static_cast<float>(std::remainder(point.angle * kPi / 180.0, 2.0 * kPi));
  keypoint.response = point.response;
  return keypoint;
}

class SiftExtractor : public FeatureExtractor {
 public:
  SiftExtractor(const SiftParameters& parameters, int max_features)
      : parameters_(parameters), max_features_(max_features) {
#if !RGBD_OPENCV_HAS_SIFT
    throw std::invalid_argument("feature_extraction/descriptor is 'sift': OpenCV " CV_VERSION
                                " has none, 4.4 or later has");
#endif
  }

  ImageFeatures extract(const cv::Mat& gray, const cv::Mat& mask) const override {
    requireImageAndMask(gray, mask);
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    detectAndCompute(gray, mask, points, descriptors);
    std::vector<Keypoint> keypoints;
    for (const cv::KeyPoint& point : points) keypoints.push_back(fromOpenCv(point));

    std::vector<int> order(keypoints.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return strongerKeypoint(keypoints[a], keypoints[b]); });
    if (max_features_ > 0 && order.size() > static_cast<size_t>(max_features_)) order.resize(max_features_);
    return gather(keypoints, descriptors, order);
  }

 private:
  // OpenCV's object has state, so each call has its own.
  void detectAndCompute(const cv::Mat& gray, const cv::Mat& mask, std::vector<cv::KeyPoint>& points,
                        cv::Mat& descriptors) const {
#if RGBD_OPENCV_HAS_SIFT
    cv::SIFT::create(max_features_, parameters_.layers, parameters_.contrast_threshold, parameters_.edge_threshold,
                     parameters_.sigma)
        ->detectAndCompute(gray, mask, points, descriptors);
#else
    (void)gray, (void)mask, (void)points, (void)descriptors;
#endif
  }

  ImageFeatures gather(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors,
                       const std::vector<int>& order) const {
    ImageFeatures features;
    features.type = DescriptorType::kSift;
    features.descriptors.create(static_cast<int>(order.size()), descriptorLength(features.type), CV_32FC1);
    for (size_t i = 0; i < order.size(); ++i) {
      features.keypoints.push_back(keypoints[order[i]]);
      cv::Mat row = features.descriptors.row(static_cast<int>(i));
      descriptors.row(order[i]).copyTo(row);
      normalizeRow(row.ptr<float>(), row.cols, parameters_.root);
    }
    return features;
  }

  SiftParameters parameters_;
  int max_features_;
};

}  // namespace

std::unique_ptr<FeatureExtractor> makeSiftExtractor(const SiftParameters& parameters, int max_features) {
  return std::make_unique<SiftExtractor>(parameters, max_features);
}

}  // namespace recognition
