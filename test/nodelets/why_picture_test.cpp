// The picture of why: which misses it shows, and that all of it can be told apart.
#include "ros/why_picture.h"

#include <gtest/gtest.h>

#include "rgbd_recognition/annotation.h"

namespace recognition {
namespace {

const cv::Scalar kTolerance = cv::Scalar::all(60);
constexpr int kWidth = 640, kHeight = 480;
const CameraModel kCamera{kWidth, kHeight, 525.0, 525.0, 319.5, 239.5};

/// Flat plates of 0.1 m.
ModelDatabase plates(int count) {
  ModelDatabase database;
  for (int n = 0; n < count; ++n) {
    auto model = std::make_shared<ObjectModel>();
    model->name = "plate_" + std::to_string(n);
    model->extents.sigma_max = 0.14;
    for (int i = 0; i < 2500; ++i)
      model->cloud.push_back(
          {{0.002f * (i % 50) - 0.05f, 0.002f * (i / 50) - 0.05f, 0.0f}, Eigen::Vector3f::UnitZ(), {}});
    database.objects.push_back(model);
  }
  return database;
}

VerifiedHypothesis plateAt(int object, double x, double confidence, Rejection rejection) {
  VerifiedHypothesis hypothesis;
  hypothesis.hypothesis.object = object;
  hypothesis.camera_from_object = Pose(Eigen::Translation3d(x, 0.0, 1.0));
  hypothesis.confidence = confidence;
  hypothesis.rejection = rejection;
  return hypothesis;
}

class WhyPictureTest : public ::testing::Test {
 protected:
  WhyPictureTest() {
    frame_.color = cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(120));
    frame_.depth = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1.0f));
    frame_.color_camera = kCamera;
    segmentation_.labels = cv::Mat::zeros(kHeight, kWidth, CV_32SC1);
    segmentation_.edges = cv::Mat::zeros(kHeight, kWidth, CV_8UC1);
  }

  FrameAnswer answer() const { return {frame_, segmentation_, features_, tested_, found_, database_}; }

  static int pixelsOf(const cv::Mat& picture, const cv::Scalar& color) {
    cv::Mat same;  // lines are smooth: few of their pixels have all of the colour
    cv::inRange(picture, color - kTolerance, color + kTolerance, same);
    return cv::countNonZero(same);
  }

  RgbdFrame frame_;
  Segmentation segmentation_;
  SceneFeatures features_;
  std::vector<VerifiedHypothesis> tested_, found_;
  ModelDatabase database_ = plates(4);
};

TEST_F(WhyPictureTest, ofEachObjectTheNearestMissIsTold) {
  found_ = {plateAt(0, 0.0, 0.9, Rejection::kNone), plateAt(3, 0.0, 0.9, Rejection::kNone)};
  tested_ = {found_[0],
             plateAt(0, 0.01, 0.4, Rejection::kConsistency),  // where it was found
             plateAt(0, 0.3, 0.2, Rejection::kFreeSpace),     // a second one
             plateAt(3, 0.3, 0.0, Rejection::kExplained),
             plateAt(1, -0.2, 0.1, Rejection::kConsensus),
             plateAt(1, -0.3, 0.3, Rejection::kConflict),
             plateAt(2, 0.1, 0.5, Rejection::kDuplicate)};
  const auto best = bestRejected(answer());
  ASSERT_EQ(best.size(), 2u);
  EXPECT_EQ(best[0], &tested_[5]);
  EXPECT_EQ(best[1], &tested_[2]);
}

TEST_F(WhyPictureTest, showsMissesInTheirColourAndALineForEach) {
  const cv::Mat nothing = whyPicture(answer());
  EXPECT_EQ(nothing.cols, kWidth);
  EXPECT_GT(nothing.rows, kHeight) << "says that no pose was tested";
  EXPECT_EQ(pixelsOf(nothing, rejectedColor()), 0);
  found_ = {plateAt(0, 0.0, 0.9, Rejection::kNone)};
  tested_ = {found_[0], plateAt(1, 0.25, 0.3, Rejection::kConsistency)};
  const cv::Mat picture = whyPicture(answer());
  const cv::Rect frame(0, 0, kWidth, kHeight), lines(0, kHeight, kWidth, picture.rows - kHeight);
  EXPECT_GT(pixelsOf(picture(frame), rejectedColor()), 50);
  EXPECT_GT(pixelsOf(picture(frame), objectColor(0)), 50);
  EXPECT_GT(pixelsOf(picture(lines), rejectedColor()), 20);
  EXPECT_GT(pixelsOf(picture(lines), objectColor(0)), 20);
}

TEST_F(WhyPictureTest, showsSegmentsAndTheFeaturesOnWhichAPoseRests) {
  segmentation_.labels(cv::Rect(100, 100, 50, 50)).setTo(1);
  features_.image.keypoints.resize(2);
  features_.image.keypoints[0].x = 200.0f, features_.image.keypoints[0].y = 300.0f;
  features_.image.keypoints[1].x = 400.0f, features_.image.keypoints[1].y = 300.0f;
  found_ = {plateAt(0, 0.0, 0.9, Rejection::kNone)};
  found_[0].hypothesis.consensus = {{1, 0, 0.1f}};
  const cv::Mat picture = whyPicture(answer());
  EXPECT_EQ(pixelsOf(picture(cv::Rect(120, 98, 5, 5)), {255, 255, 255}), 5) << "the upper edge of the segment";
  EXPECT_EQ(pixelsOf(picture(cv::Rect(195, 295, 11, 11)), objectColor(0)), 0);
  EXPECT_GT(pixelsOf(picture(cv::Rect(395, 295, 11, 11)), objectColor(0)), 4);
}

}  // namespace
}  // namespace recognition
