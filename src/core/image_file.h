#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace recognition {

/// cv::imwrite() with its flags; throws std::runtime_error that names the file if it cannot be written.
void writeImage(const std::string& file, const cv::Mat& image, const std::vector<int>& flags = {});

}  // namespace recognition
