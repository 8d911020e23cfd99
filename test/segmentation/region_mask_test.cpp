#include "rgbd_recognition/segmentation/segmentation.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace recognition {
namespace {

Segmentation onePatch() {
  Segmentation segmentation;
  segmentation.labels = cv::Mat(20, 30, CV_32SC1, cv::Scalar(kLargePlane));
  segmentation.labels(cv::Rect(10, 5, 4, 3)).setTo(1);
  segmentation.labels(cv::Rect(0, 0, 3, 3)).setTo(kUnlabelled);
  return segmentation;
}

TEST(RegionMask, CoversPatchesAtColourResolution) {
  const cv::Mat mask = regionMask(onePatch(), {60, 50}, 2, 0);
  EXPECT_EQ(mask.type(), CV_8UC1);
  EXPECT_EQ(mask.size(), cv::Size(60, 50));
  EXPECT_EQ(cv::countNonZero(mask), 4 * 3 * 2 * 2);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(20, 10, 8, 6))), 8 * 6);
}

TEST(RegionMask, GrowsByMarginInDepthPixels) {
  const cv::Mat mask = regionMask(onePatch(), {30, 20}, 1, 2);
  EXPECT_EQ(cv::countNonZero(mask), 8 * 7);
  EXPECT_EQ(mask.at<std::uint8_t>(3, 8), 255);
  EXPECT_EQ(mask.at<std::uint8_t>(2, 8), 0);
}

TEST(RegionMask, RejectsWhatDoesNotFit) {
  EXPECT_THROW(regionMask(onePatch(), {59, 40}, 2, 0), std::invalid_argument);
  EXPECT_THROW(regionMask(onePatch(), {30, 20}, 0, 0), std::invalid_argument);
  EXPECT_THROW(regionMask(onePatch(), {30, 20}, 1, -1), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
