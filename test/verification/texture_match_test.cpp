#include "verification/texture_match.h"

#include <cmath>

#include <gtest/gtest.h>

#include "verification/pixel_consistency.h"
#include "alignment/scene_view.h"

namespace recognition {
namespace {

/// One model feature 1 m before the camera, seen by one scene feature at pixel (50, 40) of a 100 x 80 image.
class TextureMatchTest : public testing::Test {
 protected:
  TextureMatchTest() {
    model_.descriptors = cv::Mat(1, 64, CV_32FC1, cv::Scalar(1.0 / 8.0));
    model_.positions = {Eigen::Vector3f::Zero()};
    model_.view_directions = {-Eigen::Vector3f::UnitZ()};
    model_.sizes = {0.02f};
    features_.image.type = DescriptorType::kSurf64;
    features_.image.keypoints.resize(1);
    features_.image.keypoints[0].x = 50;
    features_.image.keypoints[0].y = 40;
    features_.image.keypoints[0].size = 2.0f;  // 2 cm at 1 m with f = 100
    features_.image.descriptors = model_.descriptors.clone();
    model_.descriptors = quantizedDescriptors(model_.descriptors);
    features_.points = {Eigen::Vector3f(0, 0, 1)};
    scene_.camera = {100, 80, 100.0, 100.0, 50.0, 40.0};
    scene_.features = &features_;
    reprojected_.box = cv::Rect(40, 30, 20, 20);
    state_ = cv::Mat(20, 20, CV_8UC1, cv::Scalar(static_cast<int>(PixelState::kConsistent)));
    pose_.translation() = Eigen::Vector3d(0, 0, 1);
  }

  TextureMatch match() const {
    SceneView scene = scene_;
    scene.feature_grid = FeatureGrid(features_, 1, cv::Size(100, 80));
    return matchTexture(model_, pose_, reprojected_, state_, scene);
  }

  ModelFeatures model_;
  SceneFeatures features_;
  SceneView scene_;
  ReprojectedModel reprojected_;
  cv::Mat state_;
  Pose pose_ = Pose::Identity();
};

TEST_F(TextureMatchTest, SamePlaceAndLooks) {
  EXPECT_EQ(match().features, 1);
  EXPECT_EQ(match().matched, 1);
}

TEST_F(TextureMatchTest, OtherPlace) {
  pose_.translation().x() = 0.013;  // beyond kTextureReach
  EXPECT_EQ(match().features, 1);
  EXPECT_EQ(match().matched, 0);
}

TEST_F(TextureMatchTest, OtherLooks) {
  features_.image.descriptors = -features_.image.descriptors;
  EXPECT_EQ(match().matched, 0);
}

TEST_F(TextureMatchTest, OtherSize) {
  features_.image.keypoints[0].size = 4.5f;
  EXPECT_EQ(match().matched, 0);
}

TEST_F(TextureMatchTest, SeenFromBehind) {
  model_.view_directions[0] = Eigen::Vector3f::UnitZ();
  EXPECT_EQ(match().matched, 0);
}

TEST_F(TextureMatchTest, HiddenPixelsDoNotCount) {
  state_.setTo(static_cast<int>(PixelState::kOccluded));
  EXPECT_EQ(match().features, 0);
}

TEST_F(TextureMatchTest, OtherOrientation) {
  model_.orientations = {Eigen::Vector3f::UnitX()};
  EXPECT_EQ(match().matched, 1);
  model_.orientations = {Eigen::Vector3f::UnitY()};
  EXPECT_EQ(match().matched, 0);
}

TEST_F(TextureMatchTest, WhatMatchesBesideThePoseIsNotSignificant) {
  EXPECT_GT(match().significance, 0.0);
  EXPECT_EQ(match().best_control, 0);
  model_.descriptors.push_back(model_.descriptors.clone());  // the same feature 3 cm beside
  model_.positions.push_back(Eigen::Vector3f(0.03f, 0.0f, 0.0f));
  model_.view_directions.push_back(model_.view_directions[0]);
  model_.sizes.push_back(model_.sizes[0]);
  EXPECT_EQ(match().best_control, 1);
  EXPECT_EQ(match().significance, 0.0);
}

TEST(Significance, GrowsWithTheMatchesAndFallsWithTheControls) {
  EXPECT_EQ(significanceOf(100, 0, 0), 0.0);
  EXPECT_EQ(significanceOf(100, 40, 45), 0.0);
  EXPECT_GT(significanceOf(100, 40, 5), significanceOf(100, 20, 5));
  EXPECT_GT(significanceOf(100, 40, 5), significanceOf(100, 40, 20));
}

TEST_F(TextureMatchTest, MissingDescriptorsMatchNothing) {
  features_.image.descriptors = cv::Mat();
  EXPECT_EQ(match().matched, 0);
}

}  // namespace
}  // namespace recognition
