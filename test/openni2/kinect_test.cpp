#include <gtest/gtest.h>

#include "openni2/depth_warp.h"
#include "openni2/kinect_clock.h"
#include "openni2/kinect_depth.h"

namespace recognition::openni2 {
namespace {

TEST(KinectClock, RunsOnOverTheTurnOfItsCounter) {
  KinectClock clock;
  EXPECT_EQ(0, clock.microseconds(0xffffff00u));
  EXPECT_EQ(1000, clock.microseconds(0xffffff00u + 60000u));
  EXPECT_EQ(30000000, clock.microseconds(0xffffff00u + 1800000000u));
  EXPECT_EQ(60000000, clock.microseconds(0xffffff00u + 3600000000u));
  EXPECT_EQ(90000000, clock.microseconds(0xffffff00u + 1105032704u));  // 5400000000 modulo 2^32
}

TEST(KinectClock, TakesTheStampsOfTwoStreamsOutOfOrder) {
  KinectClock clock;
  EXPECT_EQ(0, clock.microseconds(6000000u));
  EXPECT_EQ(33333, clock.microseconds(6000000u + 2000000u));
  EXPECT_EQ(32333, clock.microseconds(6000000u + 1940000u));
}

TEST(KinectClock, GivesFramesOfOneMomentOneIndex) {
  EXPECT_EQ(0, KinectClock::frameIndex(1900));
  EXPECT_EQ(1, KinectClock::frameIndex(33333));
  EXPECT_EQ(1, KinectClock::frameIndex(35200));
  EXPECT_EQ(300, KinectClock::frameIndex(10000000));
}

TEST(KinectDepth, AgreesWithTheTriangulationByHand) {
  // disparity (raw - 801.5) / 4 pixels of 1.042 mm baseline-normalised shift; at the reference plane exactly 1.2 m
  EXPECT_NEAR(1194, millimetresOfRaw(800), 1);
  EXPECT_NEAR(1824, millimetresOfRaw(900), 1);
  EXPECT_NEAR(501, millimetresOfRaw(400), 1);
  EXPECT_EQ(0, millimetresOfRaw(kNoRawDepth));
  EXPECT_EQ(0, millimetresOfRaw(1100));  // behind infinity
}

TEST(KinectDepth, FindsTheRawValueBack) {
  for (int raw = 500; raw < 1000; ++raw) EXPECT_EQ(raw, rawOfMillimetres(millimetresOfRaw(raw))) << raw;
  EXPECT_EQ(kNoRawDepth, rawOfMillimetres(0));
  EXPECT_EQ(kNoRawDepth, rawOfMillimetres(20000));
}

TEST(DepthWarp, MovesAPlaneByItsDisparityAndKeepsTheNearest) {
  const CameraModel camera = {8, 1, 100.0, 100.0, 3.5, 0.0};
  cv::Mat depth(1, 8, CV_16UC1, cv::Scalar(1000));
  depth.at<uint16_t>(0, 2) = 500;
  const cv::Mat warped = warpDepth(depth, camera, camera, 0.02);  // 2 pixels at 1 m, 4 at half a metre
  EXPECT_EQ(0, warped.at<uint16_t>(0, 1));
  EXPECT_EQ(1000, warped.at<uint16_t>(0, 2));
  EXPECT_EQ(0, warped.at<uint16_t>(0, 4));
  EXPECT_EQ(500, warped.at<uint16_t>(0, 6));
}

}  // namespace
}  // namespace recognition::openni2
