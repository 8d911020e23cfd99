#pragma once

#include <opencv2/core.hpp>

namespace recognition {

/// Zero-mean normalised correlation of two images in a window round each pixel.
struct LocalCorrelation {
  cv::Mat correlation;  ///< CV_32FC1, -1..1; shrunk towards 0 where contrast is lost in noise
  cv::Mat contrast;     ///< CV_32FC1, 0..1: how much there is to correlate
};

/// `model`, `scene`: CV_32FC1 lightness; `mask`: CV_32FC1, 1 where both hold. Windows of (2 radius + 1)^2 pixels, their
/// masked part. `noise`: standard deviation of the lightness that is no structure.
LocalCorrelation correlateLocally(const cv::Mat& model, const cv::Mat& scene, const cv::Mat& mask, int radius,
                                  float noise);

}  // namespace recognition
