#include "rgbd_recognition/core/distortion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "refusal.h"

namespace recognition {
namespace {

using testing::HasSubstr;

const CameraModel kCamera{640, 480, 520.0, 530.0, 310.0, 250.0};
const cv::Matx33d kMatrix(520.0, 0.0, 310.0, 0.0, 530.0, 250.0, 0.0, 0.0, 1.0);
const std::vector<cv::Point3d> kPoints = {{0.0, 0.0, 1.0}, {0.3, -0.2, 1.0}, {-0.4, 0.35, 0.9}, {0.1, 0.4, 1.2}};

void expectLikeOpenCv(const Distortion& distortion, const std::vector<cv::Point2d>& wanted) {
  distortion.validate();
  for (size_t i = 0; i < kPoints.size(); ++i) {
    const Eigen::Vector2d seen = distortion.apply({kPoints[i].x / kPoints[i].z, kPoints[i].y / kPoints[i].z});
    EXPECT_NEAR(kCamera.fx * seen.x() + kCamera.cx, wanted[i].x, 1e-6);
    EXPECT_NEAR(kCamera.fy * seen.y() + kCamera.cy, wanted[i].y, 1e-6);
  }
}

TEST(Distortion, IsThatOfOpenCv) {
  for (const std::vector<double>& d : {std::vector<double>{-0.28, 0.09, 0.001, -0.002},
                                       {-0.28, 0.09, 0.001, -0.002, 0.03},
                                       {0.5, -2.6, 0.0006, -0.0002, 1.5, 0.38, -2.4, 1.4},
                                       {0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.02, 0.03, 0.04}}) {
    std::vector<cv::Point2d> wanted;
    cv::projectPoints(kPoints, cv::Vec3d(), cv::Vec3d(), kMatrix, d, wanted);
    expectLikeOpenCv({d.size() > 5 ? "rational_polynomial" : "plumb_bob", d}, wanted);
  }
  const std::vector<double> d = {0.1, -0.05, 0.02, 0.01};
  std::vector<cv::Point2d> wanted;
  cv::fisheye::projectPoints(kPoints, wanted, cv::Vec3d(), cv::Vec3d(), kMatrix, d);
  expectLikeOpenCv({"equidistant", d}, wanted);
}

TEST(Distortion, IsUndoneInColourAndDepth) {
  const Distortion distortion{"plumb_bob", {-0.28, 0.09, 0.0, 0.0, 0.0}};
  RgbdFrame frame;
  frame.color_camera = kCamera;
  frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0));
  frame.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(1000));
  const Eigen::Vector2d ideal(0.45, -0.35), seen = distortion.apply(ideal);
  const cv::Point at(cvRound(kCamera.fx * seen.x() + kCamera.cx), cvRound(kCamera.fy * seen.y() + kCamera.cy));
  const cv::Point wanted(cvRound(kCamera.fx * ideal.x() + kCamera.cx), cvRound(kCamera.fy * ideal.y() + kCamera.cy));
  ASSERT_GT(cv::norm(at - wanted), 8.0);
  cv::circle(frame.color, at, 4, cv::Scalar::all(255), -1);
  cv::circle(frame.depth, at, 4, cv::Scalar(700), -1);
  const RgbdFrame result = undistorted(frame, distortion, kCamera);
  EXPECT_GT(result.color.at<cv::Vec3b>(wanted)[0], 200);
  EXPECT_EQ(result.depth.at<std::uint16_t>(wanted), 700);
  EXPECT_EQ(undistorted(frame, distortion, kCamera, true).depth.at<std::uint16_t>(at), 700);
  EXPECT_EQ(frame.depth.at<std::uint16_t>(at), 700);  // not touched
}

TEST(Distortion, RefusesWhatItDoesNotKnow) {
  EXPECT_NO_THROW((Distortion{"inverse_brown_conrady", {0.0, 0.0}}.validate()));
  EXPECT_THAT(refusal([] {
                Distortion{"inverse_brown_conrady", {0.1, 0.0, 0.0, 0.0, 0.0}}.validate();
              }),
              HasSubstr("'inverse_brown_conrady' is not known"));
  EXPECT_THAT(refusal([] { Distortion{"plumb_bob", {0.1, 0.0, 0.0}}.validate(); }), HasSubstr("3 coefficients"));
  EXPECT_FALSE((Distortion{"plumb_bob", {}}.isThere()));
}

}  // namespace
}  // namespace recognition
