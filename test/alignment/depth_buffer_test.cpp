#include "alignment/depth_buffer.h"

#include <gtest/gtest.h>

#include "alignment/synthetic_scene.h"
#include "alignment/prepared_model.h"

namespace recognition {
namespace {

using synthetic::poseAt;

const CameraModel kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};

TEST(DepthBuffer, SeesTheSolidWithoutHoles) {
  for (const synthetic::Solid& solid : {synthetic::box(1), synthetic::can(2)}) {
    const ObjectModel object = synthetic::makeModel(solid, "solid");
    const auto scene = synthetic::render({{solid, poseAt({0.05, -0.02, 0.5}, 20.0)}}, {object}, {});
    const ReprojectedModel seen = reproject(prepareModel(object), poseAt({0.05, -0.02, 0.5}, 20.0), kCamera);
    int missed = 0, beyond = 0, wrong = 0, all = 0;
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const bool truth = scene->instance.at<int>(v, u) == 0;
        const cv::Point in_box = cv::Point(u, v) - seen.box.tl();
        const bool inside = seen.box.contains({u, v}) && seen.point.at<int>(in_box) >= 0;
        all += truth;
        missed += truth && !inside;
        beyond += inside && !truth;
        wrong += truth && inside && std::abs(seen.depth.at<float>(in_box) - scene->depth.at<float>(v, u)) > 0.004f;
      }
    }
    EXPECT_LT(missed, 0.005 * all);
    EXPECT_LT(beyond, 0.05 * all);
    EXPECT_LT(wrong, 0.02 * all);
  }
}

TEST(DepthBuffer, NearestPointWins) {
  PreparedModel model;
  model.positions = {{0, 0, 0.1f}, {0, 0, 0}};
  model.normals = {{0, 0, -1}, {0, 0, -1}};
  model.point_radius = 0.002f;
  const ReprojectedModel seen = reproject(model, Pose(Eigen::Translation3d(0, 0, 1)), kCamera);
  EXPECT_EQ(seen.point.at<int>(cv::Point(320, 240) - seen.box.tl()), 1);
  EXPECT_NEAR(seen.depth.at<float>(cv::Point(320, 240) - seen.box.tl()), 1.0, 1e-6);
}

TEST(DepthBuffer, BackFacesAreNotSeen) {
  PreparedModel model;
  model.positions = {{0, 0, 0}};
  model.normals = {{0, 0, 1}};
  model.point_radius = 0.002f;
  EXPECT_EQ(reproject(model, Pose(Eigen::Translation3d(0, 0, 1)), kCamera).pixels, 0);
}

TEST(DepthBuffer, NothingBehindTheCameraOrOutOfView) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::box(1), "box"));
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(0, 0, -0.8), Eigen::Vector3d(3, 0, 0.8), Eigen::Vector3d(0, -2, 0.5)}) {
    const ReprojectedModel seen = reproject(model, poseAt(place), kCamera);
    EXPECT_EQ(seen.pixels, 0) << place.transpose();
    EXPECT_TRUE(seen.box.empty());
  }
}

TEST(DepthBuffer, PartlyInView) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::box(1), "box"));
  const ReprojectedModel seen = reproject(model, poseAt({0.3, 0, 0.5}), kCamera);
  EXPECT_GT(seen.pixels, 500);
  EXPECT_EQ(seen.box.x + seen.box.width, kCamera.width);
  EXPECT_EQ(seen.pixels, cv::countNonZero(seen.point >= 0));
}

TEST(PreparedModel, RejectsBadClouds) {
  ObjectModel object;
  object.name = "empty_one";
  EXPECT_THROW(prepareModel(object), std::invalid_argument);
  object = synthetic::makeModel(synthetic::box(1), "nan_one");
  object.cloud[5].normal.x() = std::nanf("");
  EXPECT_THROW(prepareModel(object), std::invalid_argument);
  EXPECT_THROW(PreparedModels(synthetic::databaseOf({object})), std::invalid_argument);
}

TEST(PreparedModel, FindsHowPointsCoverTheSurface) {
  const PreparedModel model = prepareModel(synthetic::makeModel(synthetic::box(1), "box"));
  EXPECT_GT(model.point_radius, 0.0015f);
  EXPECT_LT(model.point_radius, 0.004f);
  EXPECT_NEAR(model.radius, Eigen::Vector3f(0.05f, 0.08f, 0.03f).norm(), 0.003);
}

TEST(Symmetries, BoxHasThreeHalfTurnsAndCanManyTurns) {
  const auto of = [](const synthetic::Solid& solid) {
    return PreparedModels(synthetic::databaseOf({synthetic::makeModel(solid, "solid")})).alternatives(0);
  };
  const std::vector<SymmetricAlternative> box = of(synthetic::box(1));
  ASSERT_EQ(box.size(), 3u);
  for (const SymmetricAlternative& turned : box)
    EXPECT_NEAR(rotationDistance(turned.object_from_other, Pose::Identity()), M_PI, 1e-3);
  EXPECT_EQ(of(synthetic::can(1)).size(), 23u + 24u);
}

TEST(Symmetries, AreObjectsOfTheSameShape) {
  const PreparedModels models(synthetic::databaseOf({synthetic::makeModel(synthetic::box(1), "box"),
                                                     synthetic::makeModel(synthetic::can(2), "can"),
                                                     synthetic::makeModel(synthetic::box(3), "other_print")}));
  int others = 0;
  for (const SymmetricAlternative& alike : models.alternatives(0)) {
    EXPECT_NE(alike.object, 1);
    others += alike.object == 2;
  }
  EXPECT_EQ(others, 4);
}

}  // namespace
}  // namespace recognition
