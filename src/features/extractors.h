#pragma once

#include <memory>
#include <vector>

#include "features/feature_extractor.h"

namespace recognition {

std::unique_ptr<FeatureExtractor> makeSiftExtractor(const SiftParameters& parameters, int max_features);
std::unique_ptr<FeatureExtractor> makeSurfExtractor(const SurfParameters& parameters, DescriptorType type,
                                                    int max_features);

/// Throws std::invalid_argument unless gray is a CV_8UC1 image and mask empty or the same size and type.
void requireImageAndMask(const cv::Mat& gray, const cv::Mat& mask);

/// Strongest first, ties by place, so that the order depends on nothing but the keypoints.
bool strongerKeypoint(const Keypoint& a, const Keypoint& b);

}  // namespace recognition
