#pragma once

#include <vector>

#include "features/haar_wavelets.h"
#include "features/integral_image.h"
#include "rgbd_recognition/features/feature_types.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {

/// Orientation from Haar wavelet responses in a circle of 6 s, the longest sum in a sliding window of 60 degrees
/// (Sec. 4.1 of Bay et al.). `keypoint` in pixels of the integral image, as below; `dense` has its wavelets.
float surfOrientation(const IntegralImage& image, const HaarResponses& dense, const Keypoint& keypoint);

/// Makes the dense responses that the orientations (if `oriented`) and descriptors of the keypoints need.
void makeSurfResponses(const IntegralImage& image, const std::vector<Keypoint>& keypoints, bool oriented,
                       HaarResponses& dense);

/// Descriptor of 4 x 4 sub-regions of Haar wavelet responses (Sec. 4.2): sums of dx, dy, |dx|, |dy|, 64 in all;
/// extended, each split by the sign of the other derivative, 128 in all. Unit length; all zero where nothing varies.
class SurfDescriptor {
 public:
  SurfDescriptor(bool extended, const SurfParameters& parameters);

  /// `descriptor`: room for 64 or 128 numbers.
  void describe(const IntegralImage& image, const HaarResponses& dense, const Keypoint& keypoint,
                float* descriptor) const;

 private:
  bool extended_;
  int side_;                    // samples along a side of the window
  SampleOffsets offsets_;       // side_ x side_, row by row
  std::vector<float> profile_;  // 4 x 24: weight of a column (row) of samples in a column (row) of sub-regions
};

}  // namespace recognition
