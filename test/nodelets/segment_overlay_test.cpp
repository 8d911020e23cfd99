#include "ros/segment_overlay.h"
#include "rgbd_recognition/core/frame.h"

#include <gtest/gtest.h>

namespace recognition {
namespace {

constexpr int kGray = 100;

/// One row: nothing, a patch, a large plane, and the three kinds of edges.
Segmentation sampleSegmentation() {
  Segmentation segmentation;
  segmentation.labels = (cv::Mat_<int>(1, 6) << kUnlabelled, 1, kLargePlane, kUnlabelled, kUnlabelled, kUnlabelled);
  segmentation.edges = cv::Mat::zeros(1, 6, CV_8UC1);
  int u = 3;
  for (const EdgeType type : {EdgeType::kJump, EdgeType::kConvexCrease, EdgeType::kConcaveCrease})
    segmentation.edges.at<std::uint8_t>(0, u++) = static_cast<std::uint8_t>(type);
  return segmentation;
}

RgbdFrame grayFrame(int color_per_depth) {
  RgbdFrame frame;
  frame.depth = cv::Mat(1, 6, CV_32FC1, cv::Scalar(1.0f));
  frame.color = cv::Mat(color_per_depth, 6 * color_per_depth, CV_8UC3, cv::Scalar::all(kGray));
  frame.color_camera = {6 * color_per_depth, color_per_depth, 5.0, 5.0, 2.5, 0.0};
  return frame;
}

TEST(SegmentOverlay, ColoursEdgesByKindAndTellsPatchesFromPlanes) {
  for (const int k : {1, 2}) {
    const cv::Mat overlay = segmentOverlay(grayFrame(k), sampleSegmentation());
    ASSERT_EQ(overlay.size(), cv::Size(6 * k, k));
    const auto at = [&](int u) { return overlay.at<cv::Vec3b>(k - 1, k * u + k - 1); };
    EXPECT_EQ(at(0), cv::Vec3b::all(kGray));
    EXPECT_NE(at(1), cv::Vec3b::all(kGray));
    EXPECT_LT(at(2)[1], kGray / 2);
    EXPECT_EQ(at(3), cv::Vec3b(0, 0, 255));
    EXPECT_EQ(at(4), cv::Vec3b(0, 255, 0));
    EXPECT_EQ(at(5), cv::Vec3b(255, 0, 0));
  }
}

}  // namespace
}  // namespace recognition
