#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace recognition {

/// A Gaussian blob of `contrast` gray levels on a background of 100.
inline cv::Mat blobImage(cv::Size size, double x, double y, double sigma, double contrast) {
  cv::Mat image(size, CV_8UC1);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      const double r2 = (u - x) * (u - x) + (v - y) * (v - y);
      image.at<uchar>(v, u) = cv::saturate_cast<uchar>(100.0 + contrast * std::exp(-r2 / (2.0 * sigma * sigma)));
    }
  return image;
}

/// Random discs and rectangles of all sizes, slightly smoothed.
inline cv::Mat texturedImage(cv::Size size, int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  cv::Mat image(size, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < size.area() / 400; ++i) {
    const cv::Point centre(random.uniform(0, size.width), random.uniform(0, size.height));
    const int radius = static_cast<int>(std::exp(random.uniform(0.7, 3.2)));
    const cv::Scalar level(random.uniform(20, 236));
    if (i % 2 == 0)
      cv::circle(image, centre, radius, level, cv::FILLED);
    else
      cv::rectangle(image, cv::Rect(centre, cv::Size(radius * 2, random.uniform(2, 40))), level, cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(), 0.8);
  return image;
}

}  // namespace recognition
