#include "features/lifting.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/depth_noise.h"

namespace recognition {
namespace {

const CameraModel kCamera{160, 120, 130.0, 130.0, 79.5, 59.5};

ImageFeatures oneFeature(float x, float y, float size = 12.0f) {
  ImageFeatures features;
  features.type = DescriptorType::kSurf64;
  Keypoint keypoint;
  keypoint.x = x;
  keypoint.y = y;
  keypoint.size = size;
  features.keypoints.push_back(keypoint);
  features.descriptors = cv::Mat(1, 64, CV_32FC1, cv::Scalar(0.125));
  return features;
}

// Object at 0.8 m left of `edge`, background at 1.1 m, both noisy.
cv::Mat stepImage(int edge) {
  cv::Mat depth(120, 160, CV_32FC1);
  cv::RNG random(7);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double z = u < edge ? 0.8 : 1.1;
      depth.at<float>(v, u) = static_cast<float>(z + random.gaussian(depthSigma(z)));
    }
  return depth;
}

TEST(Lifting, NeverBetweenTheTwoDepthsOfAStep) {
  const cv::Mat depth = stepImage(80);
  for (float size : {4.0f, 12.0f, 40.0f})
    for (float x = 70.0f; x <= 90.0f; x += 0.25f) {
      const SceneFeatures scene = liftFeatures(oneFeature(x, 60.3f, size), depth, kCamera, 1);
      ASSERT_EQ(scene.points.size(), 1u);
      const double z = scene.points[0].z();
      EXPECT_LT(std::min(std::abs(z - 0.8), std::abs(z - 1.1)), 0.005) << "x " << x << " size " << size;
      if (x > 79.5f && x < 83.0f) continue;  // either surface
      EXPECT_NEAR(z, x < 80.0f ? 0.8 : 1.1, 0.005) << "x " << x << " size " << size;
    }
}

TEST(Lifting, ForegroundOwnsAnOutline) {
  const SceneFeatures scene = liftFeatures(oneFeature(80.0f, 60.0f), stepImage(80), kCamera, 1);
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_NEAR(scene.points[0].z(), 0.8, 0.005);
}

TEST(Lifting, SlantedPlaneIsExact) {
  cv::Mat depth(120, 160, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      depth.at<float>(v, u) = static_cast<float>(1.0 / (0.9 + 0.004 * (u - 80) + 0.002 * (v - 60)));
  const SceneFeatures scene = liftFeatures(oneFeature(85.4f, 50.7f), depth, kCamera, 1);
  ASSERT_EQ(scene.points.size(), 1u);
  const double z = 1.0 / (0.9 + 0.004 * 5.4 - 0.002 * 9.3);
  EXPECT_NEAR(scene.points[0].z(), z, 2e-4);
  EXPECT_NEAR(scene.points[0].x(), (85.4 - 79.5) / 130.0 * z, 2e-4);
  EXPECT_NEAR(scene.points[0].y(), (50.7 - 59.5) / 130.0 * z, 2e-4);
}

TEST(Lifting, NormalIsThePlanesAndLooksAtTheCamera) {
  const Eigen::Vector3f normal = Eigen::Vector3f(0.4f, -0.3f, -1.0f).normalized();
  cv::Mat depth(120, 160, CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const Eigen::Vector3f ray = kCamera.unproject(u, v, 1.0).cast<float>();
      depth.at<float>(v, u) = normal.dot(Eigen::Vector3f(0.0f, 0.0f, 0.9f)) / normal.dot(ray);
    }
  const SceneFeatures scene = liftFeatures(oneFeature(85.4f, 50.7f), depth, kCamera, 1);
  ASSERT_EQ(scene.normals.size(), 1u);
  EXPECT_GT(scene.normals[0].dot(normal), std::cos(0.02f));
  EXPECT_EQ(scene.focal_length, 130.0f);
}

TEST(Lifting, SmallHolesAreBridgedLargeOnesAreNot) {
  cv::Mat depth(120, 160, CV_32FC1, cv::Scalar(0.9));
  depth(cv::Rect(40, 40, 5, 5)).setTo(0);    // 3 px from its centre to valid depth
  depth(cv::Rect(80, 40, 11, 11)).setTo(0);  // 6 px
  const SceneFeatures bridged = liftFeatures(oneFeature(42.0f, 42.0f), depth, kCamera, 1);
  ASSERT_EQ(bridged.points.size(), 1u);
  EXPECT_NEAR(bridged.points[0].z(), 0.9, 1e-4);
  EXPECT_EQ(bridged.without_depth.count(), 0);

  const SceneFeatures lost = liftFeatures(oneFeature(85.0f, 45.0f), depth, kCamera, 1);
  EXPECT_TRUE(lost.points.empty());
  EXPECT_EQ(lost.image.count(), 0);
  ASSERT_EQ(lost.without_depth.count(), 1);
  EXPECT_EQ(lost.without_depth.descriptors.rows, 1);
}

TEST(Lifting, ColourOfTwiceTheResolution) {
  cv::Mat depth(120, 160, CV_32FC1, cv::Scalar(1.0));
  const SceneFeatures scene = liftFeatures(oneFeature(200.5f, 100.5f), depth, kCamera, 2);
  ASSERT_EQ(scene.points.size(), 1u);
  const CameraModel color = kCamera.scaled(2.0);
  EXPECT_NEAR(scene.points[0].x(), (200.5 - color.cx) / color.fx, 1e-5);
  EXPECT_NEAR(scene.points[0].y(), (100.5 - color.cy) / color.fy, 1e-5);
}

TEST(Lifting, BelowTheDepthImageIsWithoutDepth) {
  cv::Mat depth(120, 160, CV_32FC1, cv::Scalar(1.0));
  const SceneFeatures scene = liftFeatures(oneFeature(100.0f, 250.0f), depth, kCamera, 2);
  EXPECT_TRUE(scene.points.empty());
  EXPECT_EQ(scene.without_depth.count(), 1);
}

TEST(Lifting, RejectsWrongDepth) {
  EXPECT_THROW(liftFeatures(oneFeature(1, 1), cv::Mat(9, 9, CV_16UC1), kCamera, 1), std::invalid_argument);
  EXPECT_THROW(liftFeatures(oneFeature(1, 1), cv::Mat(9, 9, CV_32FC1), kCamera, 0), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
