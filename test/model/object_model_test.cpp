#include "rgbd_recognition/model/object_model.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace recognition {
namespace {

std::vector<SurfacePoint> cloudOf(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<SurfacePoint> cloud;
  for (const auto& p : positions) cloud.push_back({p, Eigen::Vector3f::UnitZ(), cv::Vec3b()});
  return cloud;
}

// Six points at +-a, +-b, +-c on the axes have the covariance diag(a^2, b^2, c^2) / 3.
TEST(Extents, Equation4ByHand) {
  const Extents extents =
      computeExtents(cloudOf({{0.3f, 0, 0}, {-0.3f, 0, 0}, {0, 0.2f, 0}, {0, -0.2f, 0}, {0, 0, 0.1f}, {0, 0, -0.1f}}));
  EXPECT_NEAR(extents.sigma_min, 6.0 * std::sqrt(0.01 / 3.0), 1e-6);         // 0.34641
  EXPECT_NEAR(extents.sigma_max, 6.0 * std::sqrt(0.09 / 3.0), 1e-6);         // 1.03923
  EXPECT_NEAR(extents.sigma_d, 3.0 * std::sqrt((0.04 + 0.01) / 3.0), 1e-6);  // 0.38730
}

TEST(Extents, FollowNeitherPlaceNorOrientation) {
  const std::vector<Eigen::Vector3f> box = {{0.3f, 0, 0},  {-0.3f, 0, 0}, {0, 0.2f, 0},
                                            {0, -0.2f, 0}, {0, 0, 0.1f},  {0, 0, -0.1f}};
  std::vector<Eigen::Vector3f> moved;
  const Eigen::Isometry3f pose =
      Eigen::Translation3f(1, 2, 3) * Eigen::AngleAxisf(1.0f, Eigen::Vector3f(1, 1, 1).normalized());
  for (const auto& p : box) moved.push_back(pose * p);
  const Extents a = computeExtents(cloudOf(box)), b = computeExtents(cloudOf(moved));
  EXPECT_NEAR(a.sigma_min, b.sigma_min, 1e-5);
  EXPECT_NEAR(a.sigma_max, b.sigma_max, 1e-5);
  EXPECT_NEAR(a.sigma_d, b.sigma_d, 1e-5);
}

TEST(Extents, NeedFourPoints) {
  EXPECT_THROW(computeExtents(cloudOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})), std::invalid_argument);
}

TEST(ModelDatabase, FindsByNameAndLimitsSizes) {
  ModelDatabase database;
  EXPECT_EQ(extentLimits(database).sigma_max, 0.0);
  for (const double scale : {1.0, 3.0, 2.0}) {
    auto model = std::make_shared<ObjectModel>();
    model->name = "object" + std::to_string(database.objects.size());
    model->extents = {scale, 10 * scale, 5 * scale};
    database.objects.push_back(model);
  }
  EXPECT_EQ(database.find("object1"), 1);
  EXPECT_EQ(database.find("other"), -1);
  EXPECT_EQ(extentLimits(database).sigma_min, 1.0);
  EXPECT_EQ(extentLimits(database).sigma_max, 30.0);
}

}  // namespace
}  // namespace recognition
