#include "verification/pixel_consistency.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

#include <gtest/gtest.h>

namespace recognition {
namespace {

/// A model of four points in a row, each on a pixel of its own, before a camera in which pixel (10 + i, 10) sees point
/// i at depth 1.
class FourPixels : public ::testing::Test {
 protected:
  FourPixels() {
    camera_ = {20, 20, 100.0, 100.0, 10.0, 10.0};
    for (int i = 0; i < 4; ++i) {
      model_.positions.emplace_back(0.01f * static_cast<float>(i), 0.0f, 0.0f);
      model_.normals.emplace_back(0.0f, 0.0f, -1.0f);
      model_.lab.emplace_back(50.0f, 0.0f, 0.0f);
    }
    model_.point_radius = 0.004f;
    scene_.depth = cv::Mat(20, 20, CV_32FC1, cv::Scalar(1.0));
    scene_.lab = cv::Mat(20, 20, CV_32FC3, cv::Scalar(90, 0, 0));
    for (int u = 10; u < 14; ++u) scene_.lab.at<cv::Vec3f>(10, u) = {50, 0, 0};
    scene_.clipped = cv::Mat(20, 20, CV_8UC1, cv::Scalar(0));
    scene_.camera = camera_;
    segmentation_.labels = cv::Mat(20, 20, CV_32SC1, cv::Scalar(0));
    parameters_.epsilon_d = 0.02;
    parameters_.epsilon_d_noise = 0.0;
    parameters_.epsilon_c = 5.0;
    parameters_.w = 0;
    parameters_.w_c = 0.6;
  }

  void addPatch(const cv::Rect& rect) {
    Patch patch{};
    patch.centroid.setZero();
    patch.eigenvalues.setZero();
    patch.axes.setIdentity();
    patch.label = static_cast<int>(segmentation_.patches.size()) + 1;
    patch.pixels = rect.area();
    segmentation_.labels(rect).setTo(patch.label);
    segmentation_.patches.push_back(patch);
  }

  ConsistencyScores scores(const ColorTransform& illumination = {}) {
    const ReprojectedModel seen = reproject(model_, Pose(Eigen::Translation3d(0, 0, 1)), camera_);
    const PixelConsistency pixels{testDepth(seen, scene_, parameters_),
                                  testColor(seen, model_, illumination, scene_, parameters_)};
    return consistencyScores(pixels, seen.box, segmentation_, parameters_.w_c);
  }

  CameraModel camera_;
  PreparedModel model_;
  SceneView scene_;
  Segmentation segmentation_;
  VerificationParameters parameters_;
};

TEST_F(FourPixels, AllAgree) {
  addPatch({10, 10, 4, 2});  // eight pixels, four of them the model's
  const ConsistencyScores s = scores();
  EXPECT_EQ(s.projected, 4);
  EXPECT_DOUBLE_EQ(s.s_d, 1.0);
  EXPECT_DOUBLE_EQ(s.s_c, 1.0);
  EXPECT_EQ(s.best_segment, 1);
  EXPECT_DOUBLE_EQ(s.s_o, 0.5);
  EXPECT_DOUBLE_EQ(s.total, 0.5);
}

TEST_F(FourPixels, HandComputed) {
  addPatch({10, 10, 1, 1});                       // pixel 10
  addPatch({11, 10, 3, 1});                       // pixels 11, 12, 13
  scene_.depth.at<float>(10, 13) = 1.1f;          // 1_d fails at 13: seen through
  scene_.lab.at<cv::Vec3f>(10, 12) = {50, 6, 0};  // 1_c fails at 12
  const ConsistencyScores s = scores();
  EXPECT_DOUBLE_EQ(s.s_d, 0.75);
  EXPECT_DOUBLE_EQ(s.s_c, 0.75);
  EXPECT_EQ(s.best_segment, 1);  // f = 1 for both segments; the first is taken
  EXPECT_DOUBLE_EQ(s.s_o, 1.0);
  EXPECT_DOUBLE_EQ(s.total, 0.6 * 0.75 + 0.4 * 0.75);
  EXPECT_DOUBLE_EQ(s.free_space, 0.25);
  EXPECT_DOUBLE_EQ(s.visible, 1.0);
}

TEST_F(FourPixels, BestSegmentHasTheLargestConsistentOverlap) {
  addPatch({10, 10, 1, 1});
  addPatch({11, 10, 3, 3});
  const ConsistencyScores s = scores();
  EXPECT_EQ(s.best_segment, 2);  // f = 3 against 1, though its share of the segment is 3/9
  EXPECT_DOUBLE_EQ(s.s_o, 1.0 / 3.0);
}

TEST_F(FourPixels, NearerIsOccludedNoDepthIsUnknown) {
  scene_.depth.at<float>(10, 10) = 0.5f;
  scene_.depth.at<float>(10, 11) = 0.0f;
  const ConsistencyScores s = scores();
  EXPECT_DOUBLE_EQ(s.visible, 0.75);
  EXPECT_DOUBLE_EQ(s.free_space, 0.0);
  EXPECT_DOUBLE_EQ(s.s_d, 0.5);
  EXPECT_DOUBLE_EQ(s.total, 0.0);  // no segment
  EXPECT_EQ(s.best_segment, 0);
}

TEST_F(FourPixels, RangesAreComparedNotDepths) {
  // At pixel 13 the ray is sqrt(1 + 0.03^2) long for each metre of depth: 20 mm of range are 19.991 mm of depth.
  const double ray = std::sqrt(1.0 + 0.03 * 0.03);
  scene_.depth.at<float>(10, 13) = static_cast<float>(1.0 + 0.02 / ray + 1e-5);
  EXPECT_DOUBLE_EQ(scores().s_d, 0.75);
  scene_.depth.at<float>(10, 13) = static_cast<float>(1.0 + 0.02 / ray - 1e-5);
  EXPECT_DOUBLE_EQ(scores().s_d, 1.0);
}

TEST_F(FourPixels, ColourMayLieInTheWindow) {
  scene_.lab.setTo(cv::Scalar(90, 0, 0));
  scene_.lab.at<cv::Vec3f>(8, 10) = {50, 0, 0};
  parameters_.w = 1;
  EXPECT_DOUBLE_EQ(scores().s_c, 0.0);
  parameters_.w = 2;
  EXPECT_DOUBLE_EQ(scores().s_c, 0.75);  // pixels 10, 11 and 12 have it within two pixels
}

TEST_F(FourPixels, LightTurnsTheModelsColours) {
  ColorTransform illumination;
  illumination.a(0, 0) = 1.4f;
  illumination.b[1] = 10.0f;
  EXPECT_DOUBLE_EQ(scores(illumination).s_c, 0.0);
  for (int u = 10; u < 14; ++u) scene_.lab.at<cv::Vec3f>(10, u) = {70, 10, 0};
  EXPECT_DOUBLE_EQ(scores(illumination).s_c, 1.0);
}

TEST_F(FourPixels, ToleranceGrowsWithTheSensorsNoise) {
  EXPECT_DOUBLE_EQ(depthTolerance(parameters_, 2.0), 0.02);
  parameters_.epsilon_d_noise = 2.0;
  EXPECT_DOUBLE_EQ(depthTolerance(parameters_, 2.0), 0.02 + 2.0 * 1.425e-3 * 4.0);
}

}  // namespace
}  // namespace recognition
