#include <algorithm>
#include <numeric>
#include <opencv2/core/utility.hpp>

#include "features/extractors.h"
#include "features/integral_image.h"
#include "features/surf_descriptor.h"
#include "features/surf_detector.h"
#include "features/feature_extractor.h"

namespace recognition {
namespace {

Keypoint toOriginal(Keypoint keypoint, const IntegralImage& image) {
  keypoint.x = image.toOriginal(keypoint.x);
  keypoint.y = image.toOriginal(keypoint.y);
  keypoint.size = image.lengthToOriginal(keypoint.size);
  return keypoint;
}

/// Keypoints in an order in which windows lie near those before them, so that their pixels are in the cache.
std::vector<int> nearOnesTogether(const std::vector<Keypoint>& keypoints) {
  constexpr float kStrip = 48.0f;  // rows, about a window's
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](int i) { return std::make_pair(static_cast<int>(keypoints[i].y / kStrip), keypoints[i].x); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return place(a) < place(b); });
  return order;
}

class SurfExtractor : public FeatureExtractor {
 public:
  SurfExtractor(const SurfParameters& parameters, DescriptorType type, int max_features)
      : parameters_(parameters),
        type_(type),
        max_features_(max_features),
        descriptor_(type == DescriptorType::kSurf128, parameters) {}

  ImageFeatures extract(const cv::Mat& gray, const cv::Mat& mask) const override {
    requireImageAndMask(gray, mask);
    const IntegralImage image(gray, gray.cols < parameters_.double_below_width);
    std::vector<Keypoint> keypoints = detectSurf(image, mask, parameters_);
    keepInside(image, mask, keypoints);
    std::sort(keypoints.begin(), keypoints.end(), strongerKeypoint);
    if (max_features_ > 0 && keypoints.size() > static_cast<size_t>(max_features_)) keypoints.resize(max_features_);
    return describe(image, keypoints);
  }

 private:
  static void keepInside(const IntegralImage& image, const cv::Mat& mask, std::vector<Keypoint>& keypoints) {
    if (mask.empty()) return;
    const auto outside = [&](const Keypoint& k) {
      return mask.at<uchar>(cvRound(image.toOriginal(k.y)), cvRound(image.toOriginal(k.x))) == 0;
    };
    keypoints.erase(std::remove_if(keypoints.begin(), keypoints.end(), outside), keypoints.end());
  }

  ImageFeatures describe(const IntegralImage& image, std::vector<Keypoint>& keypoints) const {
    ImageFeatures features;
    features.type = type_;
    features.descriptors = cv::Mat::zeros(static_cast<int>(keypoints.size()), descriptorLength(type_), CV_32FC1);
    features.keypoints.resize(keypoints.size());
    thread_local HaarResponses dense_of_thread;
    HaarResponses& dense = dense_of_thread;
    dense.clear();
    makeSurfResponses(image, keypoints, !parameters_.upright, dense);
    const std::vector<int> order = nearOnesTogether(keypoints);
    cv::parallel_for_(cv::Range(0, features.count()), [&](const cv::Range& range) {
      for (int at = range.start; at < range.end; ++at) {
        const int i = order[at];
        if (!parameters_.upright) keypoints[i].angle = surfOrientation(image, dense, keypoints[i]);
        descriptor_.describe(image, dense, keypoints[i], features.descriptors.ptr<float>(i));
        features.keypoints[i] = toOriginal(keypoints[i], image);
      }
    });
    return features;
  }

  SurfParameters parameters_;
  DescriptorType type_;
  int max_features_;
  SurfDescriptor descriptor_;
};

}  // namespace

std::unique_ptr<FeatureExtractor> makeSurfExtractor(const SurfParameters& parameters, DescriptorType type,
                                                    int max_features) {
  return std::make_unique<SurfExtractor>(parameters, type, max_features);
}

}  // namespace recognition
