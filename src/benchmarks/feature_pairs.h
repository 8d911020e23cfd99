#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace recognition {

/// Two noisy pictures of the same thing with the truth of where each pixel of the first went.
struct FeaturePair {
  cv::Mat first, second;            ///< CV_8UC1
  cv::Mat first_mask, second_mask;  ///< CV_8UC1
  cv::Mat place;                    ///< CV_32FC2 in `first`: place in `second`, pixels; NaN where it is not seen there
};

/// Six objects of a BOP `models` folder seen from two sides: up to 35 degrees apart, turned in the image, nearer or
/// farther, in other light.
std::vector<FeaturePair> renderedPairs(const std::string& models, int count, cv::Size size, std::uint64_t seed);

/// Pictures and their views from another side (homographies up to 45 degrees), for folders without models.
std::vector<FeaturePair> warpedPairs(const std::vector<cv::Mat>& pictures, std::uint64_t seed);

}  // namespace recognition
