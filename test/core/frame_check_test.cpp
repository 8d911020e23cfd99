#include "core/frame_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace recognition {
namespace {

using testing::HasSubstr;

// A table: depth from 0.7 m at the lower edge to 1.4 m at the upper one, with a tenth of it not measured.
RgbdFrame table() {
  RgbdFrame frame;
  frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(1, 2, 3));
  frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(0));
  for (int v = 48; v < 480; ++v) frame.depth.row(v).setTo(1.4 - 0.7 * v / 480.0);
  frame.color_camera = {640, 480, 525.0, 525.0, 319.5, 239.5};
  return frame;
}

RgbdFrame scaled(double factor) {
  RgbdFrame frame = table();
  frame.depth *= factor;
  return frame;
}

TEST(FrameCheck, FindsAnOrdinaryFrameFit) {
  EXPECT_EQ(frameProblem(table()), "");
  RgbdFrame frame = table();
  frame.depth.convertTo(frame.depth, CV_16U, 1000.0);
  EXPECT_EQ(frameProblem(frame), "");
  frame.color_camera.cx = 100.0;  // a picture cut out to one side
  EXPECT_EQ(frameProblem(frame), "");
  EXPECT_NO_THROW(requireFit(frame));
}

TEST(FrameCheck, NamesACameraOfAnotherResolution) {
  for (const double factor : {2.0, 1.5, 0.5}) {
    RgbdFrame frame = table();
    frame.color_camera = frame.color_camera.scaled(factor);
    frame.color_camera.width = 640, frame.color_camera.height = 480;
    EXPECT_THAT(frameProblem(frame), HasSubstr("principal point")) << factor;
    EXPECT_THAT(refusal([&] { requireFit(frame); }), HasSubstr("640x480"));
  }
  RgbdFrame frame = table();
  frame.color_camera.cy = 482.6;
  EXPECT_THAT(frameProblem(frame), HasSubstr("(320, 483) is outside of the 640x480 picture"));
  frame = table();
  frame.color_camera.fx = frame.color_camera.fy = 60.0;
  EXPECT_THAT(frameProblem(frame), HasSubstr("focal lengths"));
}

TEST(FrameCheck, NamesDepthThatIsEmptyOrOfAnotherUnit) {
  RgbdFrame frame = table();
  frame.depth.setTo(0);
  EXPECT_THAT(frameProblem(frame), HasSubstr("depth image is empty"));
  frame.depth(cv::Rect(300, 200, 20, 20)).setTo(1.0);
  EXPECT_THAT(frameProblem(frame), HasSubstr("% of the depth image are measured"));
  EXPECT_THAT(frameProblem(scaled(10.0)), HasSubstr("ten times too large"));
  EXPECT_THAT(frameProblem(scaled(1000.0)), HasSubstr("in millimetres, and read as metres"));
  EXPECT_THAT(frameProblem(scaled(0.1)), HasSubstr("too small"));
  EXPECT_THAT(frameProblem(scaled(0.001)), HasSubstr("too small"));
  frame = table();
  frame.depth.rowRange(48, 150).setTo(4.0);  // a wall behind it
  EXPECT_EQ(frameProblem(frame), "");
  frame.depth *= 0.1;
  EXPECT_THAT(frameProblem(frame), HasSubstr("ends at 0.4 m; is its scale right, or ten"));
}

TEST(FrameCheck, NamesARotatedColourImage) {
  RgbdFrame frame = table();
  cv::rotate(frame.color, frame.color, cv::ROTATE_90_CLOCKWISE);
  frame.color_camera = {480, 640, 525.0, 525.0, 239.5, 319.5};
  EXPECT_THAT(refusal([&] { frame.validate(); }), HasSubstr("480x640 lies across depth 640x480"));
}

}  // namespace
}  // namespace recognition
