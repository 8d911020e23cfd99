#include "rgbd_recognition/core/frame.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace recognition {
namespace {

RgbdFrame frameOf(cv::Size color, cv::Size depth) {
  RgbdFrame frame;
  frame.color = cv::Mat(color, CV_8UC3, cv::Scalar::all(128));
  frame.depth = cv::Mat(depth, CV_16UC1, cv::Scalar(1000));
  frame.color_camera = {color.width, color.height, 1050.0, 1050.0, 639.5, 479.5};
  return frame;
}

TEST(RgbdFrame, AcceptsKinectSxga) {
  const RgbdFrame frame = frameOf({1280, 1024}, {640, 480});
  EXPECT_NO_THROW(frame.validate());
  EXPECT_EQ(frame.colorPerDepthPixel(), 2);
  EXPECT_EQ(frame.depthCamera().height, 480);
  EXPECT_DOUBLE_EQ(frame.depthCamera().fx, 525.0);
  EXPECT_DOUBLE_EQ(frame.depthCamera().cx, 319.5);
}

TEST(RgbdFrame, RejectsSizesThatDoNotFit) {
  EXPECT_THROW(frameOf({640, 480}, {600, 480}).validate(), std::invalid_argument);
  EXPECT_THROW(frameOf({320, 240}, {640, 480}).validate(), std::invalid_argument);
  EXPECT_THROW(frameOf({1280, 900}, {640, 480}).validate(), std::invalid_argument);
  RgbdFrame frame = frameOf({640, 480}, {640, 480});
  frame.color_camera.width = 320;
  EXPECT_THROW(frame.validate(), std::invalid_argument);
  frame = frameOf({640, 480}, {640, 480});
  frame.depth = cv::Mat(480, 640, CV_8UC1);
  EXPECT_THROW(frame.validate(), std::invalid_argument);
}

TEST(DepthInMetres, MillimetresBecomeMetres) {
  const cv::Mat mm = (cv::Mat_<std::uint16_t>(1, 3) << 0, 1, 1234);
  const cv::Mat m = depthInMetres(mm);
  EXPECT_FLOAT_EQ(m.at<float>(0), 0.0f);
  EXPECT_FLOAT_EQ(m.at<float>(1), 0.001f);
  EXPECT_FLOAT_EQ(m.at<float>(2), 1.234f);
}

TEST(DepthInMetres, InvalidBecomesZero) {
  const float inf = std::numeric_limits<float>::infinity();
  const cv::Mat raw = (cv::Mat_<float>(1, 5) << 0.0f, std::nanf(""), inf, -1.0f, 0.75f);
  const cv::Mat m = depthInMetres(raw);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(m.at<float>(i), 0.0f) << i;
  EXPECT_FLOAT_EQ(m.at<float>(4), 0.75f);
}

TEST(ToCielab, KnownColours) {
  // sRGB red: L* 53.24, a* 80.09, b* 67.20 (D65); in RGB and in BGR order.
  cv::Mat rgb(2, 2, CV_8UC3, cv::Scalar(255, 0, 0)), bgr(2, 2, CV_8UC3, cv::Scalar(0, 0, 255));
  for (const cv::Mat& lab : {toCielab(rgb, ColorOrder::kRgb, 1, {2, 2}), toCielab(bgr, ColorOrder::kBgr, 2, {1, 1})}) {
    const cv::Vec3f c = lab.at<cv::Vec3f>(0, 0);
    EXPECT_NEAR(c[0], 53.24, 0.5);
    EXPECT_NEAR(c[1], 80.09, 0.5);
    EXPECT_NEAR(c[2], 67.20, 0.5);
  }
}

}  // namespace
}  // namespace recognition
