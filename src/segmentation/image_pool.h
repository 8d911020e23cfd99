#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace recognition {

/// Images that are handed out and come back by themselves: one whose last outside header is gone is given out again.
class ImagePool {
 public:
  cv::Mat get(cv::Size size, int type) {
    for (cv::Mat& image : images_)
      if (CV_XADD(&image.u->refcount, 0) == 1 && image.size() == size && image.type() == type) return image;
    images_.emplace_back(size, type);
    return images_.back();
  }

 private:
  std::vector<cv::Mat> images_;
};

}  // namespace recognition
