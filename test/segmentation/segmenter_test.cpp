#include "segmentation/segmenter.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "segmentation/analytic_scene.h"

namespace recognition {
namespace {

const CameraModel kCamera{320, 240, 262.5, 262.5, 159.5, 119.5};
const Extents kLimits{0.02, 0.5, 0.2};
const Extents kNoLimits;

Pose poseAt(double x, double y, double z, double turn = 0.0, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitY()) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(turn, axis));
  return pose;
}

/// Pixels of each patch label by truth (object and face).
std::map<int, std::map<std::pair<int, int>, int>> overlaps(const Segmentation& segmentation,
                                                           const AnalyticScene::View& view) {
  std::map<int, std::map<std::pair<int, int>, int>> counts;
  for (int v = 0; v < view.depth.rows; ++v)
    for (int u = 0; u < view.depth.cols; ++u)
      ++counts[segmentation.labels.at<int>(v, u)][{view.object.at<int>(v, u), view.face.at<int>(v, u)}];
  return counts;
}

/// Share of the pixels of a smooth face that the largest patch on it has, and share of that patch that is on the face.
struct FaceMatch {
  double covered = 0.0;
  double pure = 0.0;
};
FaceMatch matchOf(const Segmentation& segmentation, const AnalyticScene::View& view, int object, int face) {
  int total = 0, best = 0, best_patch = 0;
  for (const auto& patch : overlaps(segmentation, view)) {
    for (const auto& on : patch.second) {
      if (on.first != std::make_pair(object, face)) continue;
      total += on.second;
      if (patch.first >= 1 && on.second > best) {
        best = on.second;
        best_patch = patch.first;
      }
    }
  }
  if (best == 0) return {};
  return {static_cast<double>(best) / total,
          static_cast<double>(best) / segmentation.patches[static_cast<size_t>(best_patch - 1)].pixels};
}

/// Share of pixels of an object with that label.
double shareOf(const Segmentation& segmentation, const AnalyticScene::View& view, int object, int label) {
  const cv::Mat of_object = view.object == object;
  return static_cast<double>(cv::countNonZero(of_object & (segmentation.labels == label))) /
         cv::countNonZero(of_object);
}

int countEdges(const Segmentation& segmentation, const cv::Rect& box, EdgeType type) {
  return cv::countNonZero(segmentation.edges(box) == static_cast<int>(type));
}

TEST(Segmenter, PlaneIsOnePatchOrRemovedByItsSize) {
  AnalyticScene scene;
  scene.addPlane(poseAt(0.0, 0.0, 1.0, 0.6));
  const AnalyticScene::View view = scene.render(kCamera);
  Segmenter all({}, kNoLimits);
  const Segmentation kept = all.segment(view.depth, kCamera);
  ASSERT_EQ(kept.patches.size(), 1u);
  EXPECT_EQ(kept.patches[0].pixels, cv::countNonZero(view.depth));
  EXPECT_EQ(cv::countNonZero(kept.edges), 0);
  Segmenter limited({}, kLimits);
  const Segmentation removed = limited.segment(view.depth, kCamera);
  EXPECT_TRUE(removed.patches.empty());
  EXPECT_DOUBLE_EQ(shareOf(removed, view, 0, kLargePlane), 1.0);
}

TEST(Segmenter, LargePlanesGoInAnyOrientation) {
  for (const double turn : {-1.2, -0.6, 0.0, 0.9}) {
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(Eigen::Vector3d::UnitX()), Eigen::Vector3d(Eigen::Vector3d::UnitY())}) {
      AnalyticScene scene;
      scene.addBox(poseAt(0.0, 0.0, 1.2, turn, axis), {1.5, 1.5, 0.02});
      const AnalyticScene::View view = scene.render(kCamera);
      Segmenter segmenter({}, kLimits);
      EXPECT_GT(shareOf(segmenter.segment(view.depth, kCamera), view, 0, kLargePlane), 0.95) << turn;
    }
  }
}

TEST(Segmenter, WhatStandsOnAnUnevenTableIsNotLostWithIt) {
  // Two halves that meet at 8 degrees, each shorter than a large plane; a wedge rises from one at 10. No edge parts
  // them.
  AnalyticScene scene;
  scene.addBox(poseAt(-0.25, 0.0, 1.2, 0.07), {0.5, 0.5, 0.02});
  scene.addBox(poseAt(0.25, 0.0, 1.2, -0.07), {0.5, 0.5, 0.02});
  Pose pose = poseAt(-0.25, 0.0, 1.2016, 0.07);
  pose.rotate(Eigen::AngleAxisd(0.175, Eigen::Vector3d::UnitX()));
  const int wedge = scene.addBox(pose, {0.15, 0.15, 0.05});
  const AnalyticScene::View view = scene.render(kCamera);
  const Extents limits{0.02, 0.75, 0.3};
  SegmentationParameters parameters;
  const Segmentation kept = Segmenter(parameters, limits).segment(view.depth, kCamera);
  EXPECT_GT(shareOf(kept, view, 0, kLargePlane), 0.9);
  EXPECT_GT(matchOf(kept, view, wedge, 4).covered, 0.5);  // its lower part is within the sensor's noise of the table
  parameters.hidden_plane = 0.0;
  const Segmentation dropped = Segmenter(parameters, limits).segment(view.depth, kCamera);
  EXPECT_LT(matchOf(dropped, view, wedge, 4).covered, 0.1);
}

TEST(Segmenter, FlatFaceOfAnObjectStays) {
  AnalyticScene scene;
  const int box = scene.addBox(poseAt(0.0, 0.0, 0.8, 0.3), {0.19, 0.34, 0.06});
  const AnalyticScene::View view = scene.render(kCamera);
  const double length = 0.34 * std::sqrt(3.0);  // three-sigma extent of the box, about
  Segmenter segmenter({}, {0.05, length, 0.3});
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  EXPECT_DOUBLE_EQ(shareOf(segmentation, view, box, kLargePlane), 0.0);
  EXPECT_GT(matchOf(segmentation, view, box, 4).covered, 0.97);
}

TEST(Segmenter, TableUnderObjectsGoesWhole) {
  const AnalyticScene scene = randomTableScene(5, 8);
  const AnalyticScene::View view = scene.render(kCamera);
  const cv::Mat depth = kinectDepth(view.depth, kCamera, 6);
  Segmenter segmenter({}, {0.02, 0.6, 0.2});
  const Segmentation segmentation = segmenter.segment(depth, kCamera);
  const cv::Mat seen = depth > 0;
  const cv::Mat table = (view.object == 0) & seen, objects = (view.object > 0) & seen,
                patches = segmentation.labels > 0;
  EXPECT_LT(cv::countNonZero(table & patches), 0.01 * cv::countNonZero(table));
  EXPECT_GT(cv::countNonZero(objects & patches), 0.9 * cv::countNonZero(objects));
}

TEST(Segmenter, StepIsAJumpBetweenTwoPatches) {
  AnalyticScene scene;
  scene.addPlane(poseAt(0.0, 0.0, 1.0));
  const int board = scene.addBox(poseAt(0.0, 0.0, 0.9), {0.3, 0.3, 0.02});
  const AnalyticScene::View view = scene.render(kCamera);
  Segmenter segmenter({}, kNoLimits);
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  EXPECT_EQ(segmentation.patches.size(), 2u);
  EXPECT_EQ(countEdges(segmentation, {0, 0, 320, 240}, EdgeType::kConvexCrease), 0);
  EXPECT_GT(countEdges(segmentation, {0, 0, 320, 240}, EdgeType::kJump), 300);
  EXPECT_GT(matchOf(segmentation, view, board, 4).pure, 0.99);
  EXPECT_GT(matchOf(segmentation, view, 0, 0).covered, 0.98);
}

TEST(Segmenter, RoofIsConvexAndCornerConcave) {
  AnalyticScene roof;
  roof.addBox(poseAt(0.0, 0.0, 1.0, M_PI / 4.0), {0.3, 0.6, 0.3});
  const AnalyticScene::View view = roof.render(kCamera);
  Segmenter segmenter({}, kNoLimits);
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  const cv::Rect middle(150, 60, 20, 120);
  EXPECT_GT(countEdges(segmentation, middle, EdgeType::kConvexCrease), 100);
  EXPECT_EQ(countEdges(segmentation, middle, EdgeType::kConcaveCrease), 0);
  EXPECT_EQ(segmentation.patches.size(), 2u);

  AnalyticScene corner;
  corner.addPlane(poseAt(0.0, 0.0, 1.0, M_PI / 4.0));
  corner.addPlane(poseAt(0.0, 0.0, 1.0, -M_PI / 4.0));
  // Of two crossing planes the nearer one is seen: a corner that opens towards the camera.
  const Segmentation concave = segmenter.segment(corner.render(kCamera).depth, kCamera);
  EXPECT_GT(countEdges(concave, middle, EdgeType::kConcaveCrease), 100);
  EXPECT_EQ(countEdges(concave, middle, EdgeType::kConvexCrease), 0);
  EXPECT_EQ(concave.patches.size(), 2u);
}

TEST(Segmenter, SphereAndCylinderAreOnePatchASurface) {
  const CameraModel camera = kCamera.scaled(2.0);
  AnalyticScene scene;
  const int sphere = scene.addSphere({-0.15, 0.0, 0.8}, 0.08);
  const int cylinder = scene.addCylinder(poseAt(0.15, 0.0, 0.8, 0.5, Eigen::Vector3d::UnitX()), 0.05, 0.2);
  const AnalyticScene::View view = scene.render(camera);
  Segmenter segmenter({}, kNoLimits);
  const Segmentation segmentation = segmenter.segment(view.depth, camera);
  EXPECT_GT(matchOf(segmentation, view, sphere, 0).covered, 0.8);
  EXPECT_GT(matchOf(segmentation, view, sphere, 0).pure, 0.99);
  EXPECT_GT(matchOf(segmentation, view, cylinder, 0).pure, 0.9);
}

TEST(Segmenter, TouchingBoxesAreSeparate) {
  AnalyticScene scene;
  const int left = scene.addBox(poseAt(-0.1, 0.0, 0.9), {0.2, 0.2, 0.2});
  const int right = scene.addBox(poseAt(0.1, 0.0, 0.95), {0.2, 0.3, 0.2});
  const AnalyticScene::View view = scene.render(kCamera);
  Segmenter segmenter({}, kNoLimits);
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  for (const int box : {left, right}) {
    EXPECT_GT(matchOf(segmentation, view, box, 4).covered, 0.97);
    EXPECT_GT(matchOf(segmentation, view, box, 4).pure, 0.99);
  }
}

TEST(Segmenter, PatchesDescribeTheirPixels) {
  AnalyticScene scene;
  scene.addBox(poseAt(0.05, -0.02, 0.9), {0.2, 0.1, 0.1});
  const AnalyticScene::View view = scene.render(kCamera);
  Segmenter segmenter({}, kLimits);
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  ASSERT_EQ(segmentation.patches.size(), 1u);
  const Patch& patch = segmentation.patches[0];
  EXPECT_EQ(patch.label, 1);
  EXPECT_EQ(patch.pixels, cv::countNonZero(segmentation.labels == 1));
  EXPECT_NEAR(patch.centroid.x(), 0.05, 0.003);
  EXPECT_NEAR(patch.centroid.z(), 0.85, 0.003);
  EXPECT_NEAR(6.0 * std::sqrt(patch.eigenvalues[2]), 0.2 * std::sqrt(3.0), 0.01);
  EXPECT_NEAR(std::abs(patch.axes(0, 2)), 1.0, 1e-3);  // the long axis is x
  EXPECT_NEAR(std::abs(patch.axes(2, 0)), 1.0, 1e-3);  // the face looks along z
}

TEST(Segmenter, DropsPatchesOfTheWrongSize) {
  AnalyticScene scene;
  const int crumb = scene.addBox(poseAt(-0.2, 0.0, 0.8), {0.02, 0.02, 0.02});
  const int fitting = scene.addBox(poseAt(0.1, 0.0, 0.8), {0.1, 0.2, 0.1});
  const AnalyticScene::View view = scene.render(kCamera);
  SegmentationParameters parameters;
  parameters.min_pixels = 1;
  Segmenter segmenter(parameters, {0.2, 0.5, 0.2});
  const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
  EXPECT_EQ(segmentation.patches.size(), 1u);
  EXPECT_DOUBLE_EQ(shareOf(segmentation, view, crumb, kUnlabelled), 1.0);
  EXPECT_GT(matchOf(segmentation, view, fitting, 4).covered, 0.97);
}

TEST(Segmenter, HolesTakeNothingFromTheirSurroundings) {
  AnalyticScene scene;
  scene.addBox(poseAt(0.0, 0.0, 0.8), {0.3, 0.3, 0.1});
  AnalyticScene::View view = scene.render(kCamera);
  const float holes[] = {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
  int made = 0;
  for (int v = 80; v < 160; v += 7)
    for (int u = 120; u < 200; u += 5) view.depth.at<float>(v, u) = holes[made++ % 4];
  for (const NoiseModel model : {NoiseModel::kConstant, NoiseModel::kSensor}) {
    SegmentationParameters parameters;
    parameters.noise_model = model;
    Segmenter segmenter(parameters, kLimits);
    const Segmentation segmentation = segmenter.segment(view.depth, kCamera);
    ASSERT_EQ(segmentation.patches.size(), 1u);
    EXPECT_EQ(segmentation.patches[0].pixels, cv::countNonZero(view.object == 0) - made);
    EXPECT_TRUE(segmentation.patches[0].centroid.allFinite());
  }
}

TEST(Segmenter, SameResultForAnyNumberOfThreads) {
  const AnalyticScene::View view = randomTableScene(11, 8).render(kCamera);
  const cv::Mat depth = kinectDepth(view.depth, kCamera, 12);
  Segmenter segmenter({}, {0.02, 0.6, 0.2});
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const Segmentation one = segmenter.segment(depth, kCamera);
  for (const int n : {2, 8}) {
    cv::setNumThreads(n);
    const Segmentation many = segmenter.segment(depth, kCamera);
    EXPECT_EQ(cv::norm(one.labels, many.labels, cv::NORM_INF), 0.0) << n;
    EXPECT_EQ(cv::norm(one.edges, many.edges, cv::NORM_INF), 0.0) << n;
    ASSERT_EQ(one.patches.size(), many.patches.size());
    for (size_t i = 0; i < one.patches.size(); ++i) EXPECT_EQ(one.patches[i].centroid, many.patches[i].centroid);
  }
  cv::setNumThreads(threads);
}

TEST(Segmenter, ResultsOutliveLaterCallsAndMemoryComesBack) {
  Segmenter segmenter({}, kNoLimits);
  const cv::Mat near(240, 320, CV_32FC1, cv::Scalar(0.7)), empty(240, 320, CV_32FC1, cv::Scalar(0));
  const Segmentation kept = segmenter.segment(near, kCamera);
  const void* reused = segmenter.segment(empty, kCamera).labels.data;
  const Segmentation later = segmenter.segment(empty, kCamera);
  EXPECT_EQ(cv::countNonZero(kept.labels == 1), 320 * 240);
  EXPECT_EQ(cv::countNonZero(later.labels), 0);
  EXPECT_EQ(later.labels.data, reused);
  EXPECT_NE(later.labels.data, kept.labels.data);
}

TEST(Segmenter, RejectsWhatDoesNotFit) {
  SegmentationParameters wrong;
  wrong.sigma = 0.0;
  EXPECT_THROW(Segmenter(wrong, kNoLimits), std::invalid_argument);
  Segmenter segmenter({}, kNoLimits);
  EXPECT_THROW(segmenter.segment(cv::Mat(240, 320, CV_16UC1, cv::Scalar(1)), kCamera), std::invalid_argument);
  EXPECT_THROW(segmenter.segment(cv::Mat(480, 640, CV_32FC1, cv::Scalar(1)), kCamera), std::invalid_argument);
  EXPECT_THROW(segmenter.segment(cv::Mat(), kCamera), std::invalid_argument);
}

TEST(Segmenter, EveryModeSeparatesObjectsFromTheTable) {
  const AnalyticScene::View view = randomTableScene(21, 5).render(kCamera);
  const cv::Mat depth = kinectDepth(view.depth, kCamera, 22);
  for (const SegmentationMode mode :
       {SegmentationMode::kSimpleLinear, SegmentationMode::kSimpleQuadratic, SegmentationMode::kLsAicc,
        SegmentationMode::kLsMixed, SegmentationMode::kLsLinear, SegmentationMode::kLsQuadratic}) {
    SegmentationParameters parameters;
    parameters.mode = mode;
    parameters.epsilon = 0.015;  // the paper's: without AICc noise must stay below it
    Segmenter segmenter(parameters, {0.02, 0.6, 0.2});
    const Segmentation segmentation = segmenter.segment(depth, kCamera);
    const cv::Mat objects = (view.object > 0) & (depth > 0), patches = segmentation.labels > 0;
    EXPECT_GT(cv::countNonZero(objects & patches), 0.8 * cv::countNonZero(objects)) << static_cast<int>(mode);
    EXPECT_FALSE(segmentation.patches.empty());
  }
}

}  // namespace
}  // namespace recognition
