// Labels of the annotated picture: they do not cover other objects, nor leave the picture, and can be read at any size.
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "rgbd_recognition/annotation.h"

namespace recognition {
namespace {

const cv::Vec3b kGround(128, 128, 128);

/// A flat plate of 0.1 m.
ModelDatabase plate() {
  auto model = std::make_shared<ObjectModel>();
  for (int i = 0; i < 10000; ++i)
    model->cloud.push_back(
        {{0.001f * (i % 100) - 0.05f, 0.001f * (i / 100) - 0.05f, 0.0f}, Eigen::Vector3f::UnitZ(), {}});
  ModelDatabase database;
  database.objects.push_back(model);
  return database;
}

Annotation plateAt(double x, double y, const std::string& label) {
  return {0, Pose(Eigen::Translation3d(x, y, 1.0)), label};
}

cv::Mat drawn(int width, const std::vector<Annotation>& annotations) {
  const double f = 0.82 * width;
  const CameraModel camera{width, width * 3 / 4, f, f, 0.5 * width - 0.5, 0.375 * width - 0.5};
  cv::Mat picture(camera.height, camera.width, CV_8UC3, cv::Scalar(128, 128, 128));
  drawAnnotations(picture, annotations, plate(), camera);
  return picture;
}

/// Where labels' black ground is.
cv::Mat labelsIn(const cv::Mat& picture) {
  cv::Mat black;
  cv::inRange(picture, cv::Scalar(0, 0, 0), cv::Scalar(0, 0, 0), black);
  return black;
}

class AnnotatedPicture : public ::testing::TestWithParam<int> {};

TEST_P(AnnotatedPicture, aLabelDoesNotCoverAnotherObject) {
  const int width = GetParam();
  const cv::Mat picture = drawn(width, {plateAt(0.0, 0.0, "lower 1.00"), plateAt(0.0, -0.12, "upper 1.00")});
  const double f = 0.82 * width;  // the upper plate without its outline
  const cv::Rect upper(cvRound(0.5 * width - 0.04 * f), cvRound(0.375 * width - 0.16 * f), cvRound(0.08 * f),
                       cvRound(0.08 * f));
  EXPECT_EQ(cv::countNonZero(labelsIn(picture)(upper)), 0);
  EXPECT_GT(cv::countNonZero(labelsIn(picture)), 0);
}

TEST_P(AnnotatedPicture, aLabelStaysInThePictureAndCanBeRead) {
  const int width = GetParam();
  const cv::Mat picture = drawn(width, {plateAt(-0.55, -0.40, "corner 1.00")});
  const cv::Rect label = cv::boundingRect(labelsIn(picture));
  EXPECT_GE(label.height, 12);
  EXPECT_GE(label.height, 0.03 * picture.rows);
  EXPECT_LE(label.height, 0.15 * picture.rows);
  EXPECT_GE(label.width, 4 * label.height) << "cut off";
}

INSTANTIATE_TEST_SUITE_P(Sizes, AnnotatedPicture, ::testing::Values(320, 640, 1280, 1920));

}  // namespace
}  // namespace recognition
