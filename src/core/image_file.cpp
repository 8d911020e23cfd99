#include "core/image_file.h"

#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

namespace recognition {

void writeImage(const std::string& file, const cv::Mat& image, const std::vector<int>& flags) {
  if (!cv::imwrite(file, image, flags)) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace recognition
