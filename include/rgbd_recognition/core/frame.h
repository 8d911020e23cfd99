#pragma once

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"

namespace recognition {

enum class ColorOrder { kBgr, kRgb };

/// One RGB-D frame. It is a view: the pixels belong to whoever made it, as cv::Mat headers share and never copy.
///
/// Depth is registered to colour: the depth pixel (u, v) sees what the k x k colour pixels at (k u, k v) see, with
/// k = colorPerDepthPixel(). Colour may have more rows below than depth covers (the Kinect's 1280x1024 over 640x480).
struct RgbdFrame {
  cv::Mat color;  ///< CV_8UC3
  ColorOrder color_order = ColorOrder::kBgr;
  cv::Mat depth;             ///< CV_16UC1 mm (0 invalid) or CV_32FC1 metres (0, NaN, Inf invalid)
  CameraModel color_camera;  ///< of `color`

  /// k >= 1, an integer. Only meaningful after validate().
  int colorPerDepthPixel() const { return color.cols / depth.cols; }

  /// Camera of `depth`: the colour camera scaled by 1/k, with the depth image's size.
  CameraModel depthCamera() const;

  /// Throws std::invalid_argument that says what does not fit (types, sizes, camera).
  void validate() const;
};

/// Depth as CV_32FC1 metres in which every invalid pixel (0, negative, NaN, Inf) is 0. The core uses no other form.
/// Throws std::invalid_argument for any other type than CV_16UC1 (mm) and CV_32FC1 (m).
cv::Mat depthInMetres(const cv::Mat& depth);

/// CV_8UC1 luminance of a CV_8UC3 image.
cv::Mat toGray(const cv::Mat& color, ColorOrder order);

/// A copy of the frame's colour as BGR, for OpenCV to draw into and write.
cv::Mat bgrCopy(const RgbdFrame& frame);

/// CIE L*a*b* (D65), CV_32FC3: L 0..100, a and b about -127..127. Its Euclidean distance is the paper's ||.||_c.
/// Colours are averaged over k x k pixels first, so that the result has depth resolution.
cv::Mat toCielab(const cv::Mat& color, ColorOrder order, int color_per_depth, cv::Size depth_size);

}  // namespace recognition
