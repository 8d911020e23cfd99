#include "rgbd_recognition/segmentation/segmentation.h"

#include <algorithm>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace rgbd_recognition {

cv::Mat regionMask(const Segmentation& segmentation, cv::Size color_size, int color_per_depth, int margin) {
  if (color_per_depth < 1 || margin < 0) throw std::invalid_argument("region mask: negative margin or scale");
  const cv::Size covered(segmentation.labels.cols * color_per_depth, segmentation.labels.rows * color_per_depth);
  if (color_size.width < covered.width || color_size.height < covered.height)
    throw std::invalid_argument("region mask: colour image is smaller than what depth covers");
  cv::Mat regions = segmentation.labels > kUnlabelled;
  if (margin > 0)
    cv::dilate(regions, regions, cv::getStructuringElement(cv::MORPH_RECT, {2 * margin + 1, 2 * margin + 1}));
  cv::Mat mask(color_size, CV_8UC1, cv::Scalar(0));
  cv::Mat part = mask(cv::Rect({0, 0}, covered));
  cv::resize(regions, part, covered, 0, 0, cv::INTER_NEAREST);
  return mask;
}

}  // namespace rgbd_recognition
