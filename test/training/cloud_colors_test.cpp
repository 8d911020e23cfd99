#include "../src/training/cloud_colors.h"

#include <gtest/gtest.h>

#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {
namespace {

const CameraModel kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};

// A camera 0.7 m above the board, which fills its view; all of it is of one colour, and counts as object.
ObjectView viewOf(const cv::Vec3b& rgb) {
  ObjectView view;
  view.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(rgb[0], rgb[1], rgb[2]));
  view.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.7));
  view.color_camera = view.depth_camera = kCamera;
  view.mask = cv::Mat(480, 640, CV_8UC1, cv::Scalar(255));
  view.camera_from_world.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  view.camera_from_world.translation().z() = 0.7;
  return view;
}

std::vector<SurfacePoint> onePoint() {
  return {{Eigen::Vector3f(0.02f, 0.01f, 0.0f), Eigen::Vector3f::UnitZ(), cv::Vec3b(1, 2, 3)}};
}

TEST(CloudColors, HighlightsAndShadowsDoNotCount) {
  std::vector<ObjectView> views(6, viewOf({80, 60, 40}));
  views.push_back(viewOf({240, 240, 240}));
  views.push_back(viewOf({5, 5, 5}));
  std::vector<SurfacePoint> cloud = onePoint();
  takeColors(views, 0.003f, cloud);
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(80, 60, 40));
}

TEST(CloudColors, OverexposedViewsCountOnlyWhereThereIsNoOther) {
  std::vector<ObjectView> views(5, viewOf({255, 255, 20}));
  std::vector<SurfacePoint> cloud = onePoint();
  takeColors(views, 0.003f, cloud);
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(255, 255, 20));
  views.push_back(viewOf({180, 170, 20}));
  takeColors(views, 0.003f, cloud);
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(180, 170, 20));
}

TEST(CloudColors, TellsWhatIsTooBrightForTheCamera) {
  ObjectView view = viewOf({80, 60, 40});
  view.color(cv::Rect(0, 0, 320, 480)).setTo(cv::Scalar(255, 255, 20));
  EXPECT_NEAR(overexposedShare(view), 0.5, 1e-6);
  view.mask(cv::Rect(0, 0, 320, 480)).setTo(0);
  EXPECT_EQ(overexposedShare(view), 0.0);
}

TEST(CloudColors, PaperTellsLightAndExposure) {
  ObjectView dark = viewOf({40, 30, 20});
  dark.paper = cv::Vec3f(120.0f, 120.0f, 60.0f);
  std::vector<SurfacePoint> cloud = onePoint();
  takeColors({dark}, 0.003f, cloud);
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(80, 60, 80));
}

TEST(CloudColors, WhatNoViewSeesKeepsItsColour) {
  std::vector<SurfacePoint> cloud = onePoint();
  cloud[0].normal = -cloud[0].normal;
  takeColors({viewOf({80, 60, 40})}, 0.003f, cloud);
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(1, 2, 3));
  ObjectView hidden = viewOf({80, 60, 40});
  hidden.depth.setTo(0.6);  // something stands in front
  takeColors({hidden}, 0.003f, cloud = onePoint());
  EXPECT_EQ(cloud[0].rgb, cv::Vec3b(1, 2, 3));
}

// The board under a lamp that makes its paper 200, 180, 150.
TEST(CloudColors, FindsThePaperBesideThePrint) {
  const FiducialBoard board = FiducialBoard::fromYaml(std::string(RGBD_SOURCE_DIR) + "/config/boards/charuco.yaml");
  ObjectView view = viewOf({30, 30, 30});
  const cv::Mat print = board.draw(525.0 / 0.7);
  cv::Mat lit;
  cv::merge(std::vector<cv::Mat>{print * (200.0 / 255), print * (180.0 / 255), print * (150.0 / 255)}, lit);
  const cv::Point corner(cvRound(319.5 - 0.5 * print.cols), cvRound(239.5 - 0.5 * print.rows));
  const cv::Rect inside = cv::Rect(corner, print.size()) & cv::Rect({}, view.color.size());
  lit(inside - corner).copyTo(view.color(inside));
  const cv::Vec3f paper = colorOfPaper(board, view);
  EXPECT_NEAR(paper[0], 200.0f, 4.0f);
  EXPECT_NEAR(paper[1], 180.0f, 4.0f);
  EXPECT_NEAR(paper[2], 150.0f, 4.0f);
  view.depth.setTo(0.5);  // the board is hidden
  EXPECT_EQ(colorOfPaper(board, view), cv::Vec3f::all(kPaper));
}

}  // namespace
}  // namespace recognition
