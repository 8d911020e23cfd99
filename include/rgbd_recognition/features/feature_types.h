#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace recognition {

enum class DescriptorType { kSurf128, kSurf64, kSift };

/// "surf128", "surf64", "sift".
const char* descriptorName(DescriptorType type);
/// Throws std::invalid_argument for an unknown name.
DescriptorType descriptorFromName(const std::string& name);
/// n of eq. (5): 128, 64, 128.
int descriptorLength(DescriptorType type);

/// Descriptors of models are kept in 8 bits, on disk and in memory: round(kDescriptorScale * x) of a unit-length
/// descriptor's element x, limited to -127..127 (elements beyond 0.635 do not occur in practice, and lose accuracy).
/// One scale for all types; a descriptor of n elements moves by at most sqrt(n) / (2 kDescriptorScale).
constexpr float kDescriptorScale = 200.0f;

/// CV_8SC1 of CV_32FC1, row by row; of CV_8SC1 itself, not copied. Throws std::invalid_argument for another type.
cv::Mat quantizedDescriptors(const cv::Mat& descriptors);
/// CV_32FC1 of unit length of CV_8SC1; of CV_32FC1 itself, not copied. Throws std::invalid_argument for another type.
cv::Mat unitDescriptors(const cv::Mat& descriptors);

struct Keypoint {
  float x = 0.0f;  ///< colour image, pixels, integer at the pixel's centre
  float y = 0.0f;
  float size = 0.0f;   ///< diameter of the neighbourhood, pixels (OpenCV's KeyPoint::size)
  float angle = 0.0f;  ///< radians, counter-clockwise from x as in an image with y down (atan2(dy, dx))
  float response = 0.0f;
  bool bright = false;  ///< sign of the Laplacian: bright blob on dark
};

/// Features of an image. Row i of `descriptors` belongs to keypoints[i].
struct ImageFeatures {
  DescriptorType type = DescriptorType::kSurf128;
  std::vector<Keypoint> keypoints;
  cv::Mat descriptors;  ///< n x descriptorLength(type), CV_32FC1, rows of unit length

  int count() const { return static_cast<int>(keypoints.size()); }
};

/// D_s of Sec. V: scene features with their 3D places.
struct SceneFeatures {
  ImageFeatures image;                  ///< those with a place
  std::vector<Eigen::Vector3f> points;  ///< camera optical frame, metres; same order as image.keypoints
  /// Of the surface under each point, camera frame, unit, towards the camera; 0 where it is not known, or empty.
  std::vector<Eigen::Vector3f> normals;
  float focal_length = 0.0f;    ///< of the colour image, pixels; 0: unknown, sizes in metres as well
  ImageFeatures without_depth;  ///< found, but no depth under them
};

}  // namespace recognition
