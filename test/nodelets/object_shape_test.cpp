// Boxes, meshes and standard messages of detections.
#include <filesystem>
#include <fstream>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "model/temporary_directory.h"
#include "ros/message_conversions.h"
#include "ros/detection_output.h"
#include "ros/object_shape.h"
#include "ros/standard_outputs.h"

namespace recognition {
namespace {

/// Points all over a block of that size, in a frame where it is at `object_from_block`.
std::vector<SurfacePoint> block(const Eigen::Vector3f& size, const Pose& object_from_block) {
  std::vector<SurfacePoint> cloud;
  for (int x = 0; x <= 4; ++x)
    for (int y = 0; y <= 4; ++y)
      for (int z = 0; z <= 4; ++z) {
        const Eigen::Vector3f p = size.cwiseProduct(Eigen::Vector3f(x, y, z) / 4.0f - Eigen::Vector3f::Constant(0.5f));
        cloud.push_back({(object_from_block * p.cast<double>()).cast<float>(), Eigen::Vector3f::UnitZ(), {}});
      }
  return cloud;
}

/// All corners of the box in the object's frame are corners of the block.
void expectHolds(const OrientedBox& box, const std::vector<SurfacePoint>& cloud) {
  for (const SurfacePoint& point : cloud) {
    const Eigen::Vector3d p = box.object_from_box.inverse() * point.position.cast<double>();
    EXPECT_TRUE((p.cwiseAbs().array() <= 0.5 * box.size.array() + 1e-4).all()) << p.transpose();
  }
}

TEST(BoxAround, keepsTheObjectsAxesWhereTheyFit) {
  const Pose moved(Eigen::Translation3d(0.1, -0.2, 0.3));
  const OrientedBox box = boxAround(block({0.2f, 0.1f, 0.05f}, moved));
  EXPECT_TRUE(box.size.isApprox(Eigen::Vector3d(0.2, 0.1, 0.05), 1e-4)) << box.size.transpose();
  EXPECT_TRUE(box.object_from_box.isApprox(moved, 1e-4));
}

TEST(BoxAround, followsABlockThatStandsObliquely) {
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    const Pose oblique = Eigen::Translation3d(0.1, 0.0, 0.2) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::Unit(axis));
    const auto cloud = block({0.2f, 0.1f, 0.05f}, oblique);
    const OrientedBox box = boxAround(cloud);
    EXPECT_NEAR(box.size.prod(), 0.2 * 0.1 * 0.05, 1e-6);
    EXPECT_NEAR(box.object_from_box.linear().determinant(), 1.0, 1e-6);
    EXPECT_TRUE(box.object_from_box.translation().isApprox(oblique.translation(), 1e-3));
    expectHolds(box, cloud);
  }
}

TEST(BoxAround, ofNothingIsNothing) { EXPECT_TRUE(boxAround({}).size.isZero()); }

TEST(MeshUri, namesAFileThatIsThere) {
  const TemporaryDirectory folder;
  const std::string file = folder.string() + "/box.ply";
  std::ofstream(file) << "ply\n";
  ObjectModel model;
  model.source = file;
  EXPECT_EQ(meshUri(model), "") << "trained from a recording of that name";
  model.provenance["mesh_unit"] = "0.001";
  EXPECT_EQ(meshUri(model), "file://" + file);
  std::filesystem::remove(file);
  EXPECT_EQ(meshUri(model), "");
  model.source = "box.ply";
  EXPECT_EQ(meshUri(model), "") << "relative to a folder that nobody knows";
}

class ShapeMessages : public ::testing::Test {
 protected:
  void SetUp() override {
    auto model = std::make_shared<ObjectModel>();
    model->name = "box";
    model->cloud = block({0.2f, 0.1f, 0.05f}, Pose(Eigen::Translation3d(0.0, 0.0, 0.025)));
    database_.objects.push_back(model);
    detections_.header.frame_id = "optical";
    detections_.detections.resize(2);
    for (auto& detection : detections_.detections) {
      detection.object = "box";
      detection.pose.pose = poseMessage(Pose(Eigen::Translation3d(0.0, 0.0, 1.0)));
    }
    detections_.detections.front().accepted = true;
    ObjectShapes().fillIn(database_, &detections_);
  }

  ModelDatabase database_;
  messages::DetectionArray detections_;
};

TEST_F(ShapeMessages, boxIsInTheFrameOfThePose) {
  const messages::Detection& detection = detections_.detections.front();
  EXPECT_NEAR(detection.size.x, 0.2, 1e-4);
  EXPECT_NEAR(detection.size.z, 0.05, 1e-4);
  EXPECT_NEAR(detection.box.position.z, 1.025, 1e-4);
  changeFrame(Pose(Eigen::Translation3d(5.0, 0.0, 0.0)), "base", &detections_);
  EXPECT_NEAR(detections_.detections.front().box.position.x, 5.0, 1e-4);
  EXPECT_NEAR(detections_.detections.front().box.position.z, 1.025, 1e-4);
}

TEST_F(ShapeMessages, posesAreOfTheAccepted) {
  const auto poses = posesOf(detections_);
  EXPECT_EQ(poses->header.frame_id, "optical");
  ASSERT_EQ(poses->poses.size(), 1u);
  EXPECT_EQ(poses->poses.front().position.z, 1.0);
}

#ifdef RGBD_RECOGNITION_VISION_MSGS
TEST_F(ShapeMessages, visionMessagesHoldBoxAndPose) {
  const auto array = detections3dOf(detections_, database_);
  ASSERT_EQ(array->detections.size(), 1u);
  EXPECT_NEAR(array->detections.front().bbox.center.position.z, 1.025, 1e-4);
  EXPECT_NEAR(array->detections.front().bbox.size.y, 0.1, 1e-4);
  EXPECT_EQ(array->detections.front().results.front().pose.pose.position.z, 1.0);
}
#endif

}  // namespace
}  // namespace recognition
