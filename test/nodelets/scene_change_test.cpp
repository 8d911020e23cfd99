// What counts as a change of what is in view.
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "ros/scene_change.h"

namespace recognition {
namespace {

/// A wall at one metre, with the noise of a sensor.
RgbdFrame wall(std::uint64_t seed) {
  RgbdFrame frame;
  frame.color_camera = {640, 480, 525.0, 525.0, 319.5, 239.5};
  frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(120, 120, 120));
  frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.0));
  cv::Mat noise(frame.depth.size(), CV_32FC1), color_noise(frame.color.size(), CV_8UC3);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.003);
  random.fill(color_noise, cv::RNG::UNIFORM, 0, 12);
  frame.depth += noise;
  frame.color += color_noise;
  return frame;
}

class SceneChangeTest : public ::testing::Test {
 protected:
  void SetUp() override { change_.worked(wall(1), start_); }
  bool isNew(const RgbdFrame& frame, double seconds = 1.0) {
    return change_.isNew(frame, start_ + ros::WallDuration(seconds));
  }

  const ros::WallTime start_{100.0};
  SceneChange change_{10.0};
};

TEST_F(SceneChangeTest, noiseAndHolesAreNone) {
  EXPECT_FALSE(isNew(wall(2)));
  RgbdFrame holes = wall(3);
  cv::rectangle(holes.depth, cv::Rect(100, 100, 60, 60), cv::Scalar(std::numeric_limits<float>::quiet_NaN()), -1);
  cv::rectangle(holes.depth, cv::Rect(300, 100, 60, 60), cv::Scalar(0.0), -1);
  EXPECT_FALSE(isNew(holes));
}

TEST_F(SceneChangeTest, aSmallThingIsOneByDepthOrColour) {
  RgbdFrame nearer = wall(2), painted = wall(2);
  nearer.depth(cv::Rect(300, 200, 32, 32)) -= 0.05;
  EXPECT_TRUE(isNew(nearer));
  cv::rectangle(painted.color, cv::Rect(300, 200, 32, 32), cv::Scalar(40, 40, 200), -1);
  EXPECT_TRUE(isNew(painted));
}

TEST_F(SceneChangeTest, theRestHasAnEnd) {
  EXPECT_FALSE(isNew(wall(2), 9.9));
  EXPECT_TRUE(isNew(wall(2), 10.0));
}

TEST_F(SceneChangeTest, withoutRestAllIsNew) {
  SceneChange never;
  never.worked(wall(1), start_);
  EXPECT_TRUE(never.isNew(wall(1), start_));
}

TEST_F(SceneChangeTest, anotherSizeIsNew) {
  RgbdFrame wide = wall(2);
  wide.depth = wide.depth(cv::Rect(0, 0, 640, 240)).clone();
  wide.color = wide.color(cv::Rect(0, 0, 640, 240)).clone();
  EXPECT_TRUE(isNew(wide));
}

}  // namespace
}  // namespace recognition
