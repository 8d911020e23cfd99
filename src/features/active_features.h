#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/features/feature_types.h"

namespace recognition {

/// 1 for each feature that no accepted detection explains: `explained` is CV_8UC1 of depth resolution, not 0 where one
/// does (RoundOutcome::explained); `color_per_depth` is k of RgbdFrame.
std::vector<std::uint8_t> activeFeatures(const SceneFeatures& features, const cv::Mat& explained, int color_per_depth);

}  // namespace recognition
