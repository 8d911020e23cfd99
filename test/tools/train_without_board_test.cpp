// Objects whose poses are known without a fiducial board: from a bag's tf, from a data set's ground truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/point_grid.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/model/model_store.h"
#include "meshes/surface_sampling.h"
#include "tools/tool_run.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include "bags/bag_writer.h"
#include "rgbd_recognition/core/frame.h"
#endif

namespace recognition {
namespace {

using testing::HasSubstr;

const std::string kMesh = std::string(RGBD_TEST_DATA) + "/demo/models/obj_000003.ply";
const std::string kBoard = std::string(RGBD_SOURCE_DIR) + "/config/boards/charuco.yaml";
constexpr float kReach = 0.012f;  // metres

double nearest(const PointGrid& grid, const std::vector<SurfacePoint>& points, const Eigen::Vector3f& p) {
  float best = kReach;
  grid.forNeighbours(p, [&](int i) { best = std::min(best, (points[static_cast<size_t>(i)].position - p).norm()); });
  return static_cast<double>(best);
}

PointGrid gridOf(const std::vector<SurfacePoint>& points) {
  PointGrid grid(kReach);
  for (size_t i = 0; i < points.size(); ++i) grid.insert(points[i].position, static_cast<int>(i));
  return grid;
}

class TrainWithoutBoard : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new TemporaryDirectory;
    mesh_ = new TexturedMesh(readMesh(kMesh, 0.001));
    writeText(*directory_ / "fast.yaml", "kinect:\n  color_mode: vga\n  samples: 1\n");
    std::string arguments = "turntable --views 24 --tilts 2 --id 3 --unit 0.001 --mesh " + kMesh + " --board " +
                            kBoard + " --sensor " + (*directory_ / "fast.yaml") + " --out " + (*directory_ / "turn");
#ifdef RGBD_RECOGNITION_HAS_BAGS
    arguments += " --bag " + (*directory_ / "turn.bag");
#endif
    const ToolRun recorded = runTool(RGBD_SIMULATE, arguments);
    ASSERT_EQ(recorded.exit_code, 0) << recorded.said;
  }
  static void TearDownTestSuite() {
    delete directory_;
    delete mesh_;
  }

  static std::string file(const std::string& name) { return *directory_ / name; }
  std::string store() const { return own_ / "store"; }
  ToolRun train(const std::string& arguments) const {
    return runTool(RGBD_TRAIN, "--models " + store() + " --descriptors surf64 --name box " + arguments);
  }

  /// Where the object stands in the mesh's frame.
  static std::string standsAt() {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh_->vertices) box.extend(vertex);
    std::ostringstream text;
    text << " --stands-at " << box.center().x() << "," << box.center().y() << "," << box.min().z();
    return text.str();
  }

  /// The model is the mesh, in the mesh's own frame.
  void expectTheMesh() const {
    const ObjectModel model = ModelStore(store()).load("box");
    const std::vector<SurfacePoint> surface = sampleSurface(*mesh_, 0.002, 100000);
    const PointGrid on_surface = gridOf(surface), in_cloud = gridOf(model.cloud);
    double squares = 0.0;
    for (const SurfacePoint& point : model.cloud)
      squares += std::pow(nearest(on_surface, surface, point.position), 2) / static_cast<double>(model.cloud.size());
    EXPECT_LT(std::sqrt(squares), 0.003);
    float base = 1e9f;
    for (const SurfacePoint& point : surface) base = std::min(base, point.position.z());
    int seen = 0, covered = 0;
    for (const SurfacePoint& point : surface) {
      if (point.position.z() < base + 0.01f) continue;
      ++seen;
      covered += nearest(in_cloud, model.cloud, point.position) < 0.005;
    }
    EXPECT_GT(covered, 0.95 * seen);
    const Extents truth = computeExtents(surface);
    EXPECT_NEAR(model.extents.sigma_min, truth.sigma_min, 0.03 * truth.sigma_max);
    EXPECT_NEAR(model.extents.sigma_max, truth.sigma_max, 0.03 * truth.sigma_max);
    const ModelFeatures& features = model.features.at(DescriptorType::kSurf64);
    EXPECT_GT(features.count(), 300);
    double mean = 0.0;
    for (const Eigen::Vector3f& p : features.positions) mean += nearest(on_surface, surface, p) / features.count();
    EXPECT_LT(mean, 0.003);
  }

  static TemporaryDirectory* directory_;
  static TexturedMesh* mesh_;
  TemporaryDirectory own_;
};
TemporaryDirectory* TrainWithoutBoard::directory_ = nullptr;
TexturedMesh* TrainWithoutBoard::mesh_ = nullptr;

TEST_F(TrainWithoutBoard, PosesOfADataSetMakeTheMeshsModel) {
  const std::string frames = "--frames " + file("turn/train_kinect");
  const ToolRun trained = train(frames + " --object-id 3" + standsAt());
  EXPECT_EQ(trained.exit_code, 0) << trained.said;
  expectTheMesh();
  EXPECT_THAT(train(frames + " --object-id 3" + standsAt()).said, HasSubstr("trained already"));
  EXPECT_THAT(train(frames + " --object-id 3 --stands-at 0,0,0").said, HasSubstr("trained otherwise"));
  const ToolRun other = train(frames + " --object-id 99 --overwrite");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.said, HasSubstr("no pose of object 99"));
  EXPECT_GT(train(frames).exit_code, 100);
  EXPECT_GT(train(frames + " --object-id 3 --board " + kBoard).exit_code, 100);
}

TEST_F(TrainWithoutBoard, AModelFromABoardMayHaveTheMeshsFrame) {
  const std::string arguments = "--frames " + file("turn/train_kinect") + " --board " + kBoard;
  const ToolRun trained = train(arguments + " --board-from-object " + file("turn/board_from_object.yaml"));
  EXPECT_EQ(trained.exit_code, 0) << trained.said;
  expectTheMesh();
  const ToolRun wrong = train(arguments + " --overwrite --board-from-object " + kBoard);
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.said, testing::AllOf(HasSubstr("charuco.yaml"), HasSubstr("board_from_object")));
  EXPECT_GT(train("--frames " + file("turn/train_kinect") + " --board-from-object " + kBoard).exit_code, 100);
}

#ifdef RGBD_RECOGNITION_HAS_BAGS
TEST_F(TrainWithoutBoard, TfOfABagMakesTheMeshsModel) {
  const std::string arguments = "--bag " + file("turn.bag") + standsAt() + " --object-frame ";
  const ToolRun trained = train(arguments + "/obj_000003");
  EXPECT_EQ(trained.exit_code, 0) << trained.said;
  EXPECT_THAT(trained.said, HasSubstr("24 of 24 views used"));
  expectTheMesh();
  const ToolRun other = train(arguments + "teapot --overwrite");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.said, testing::AllOf(HasSubstr("turn.bag"), HasSubstr("'teapot'"), HasSubstr(" obj_000003")));
  EXPECT_EQ(ModelStore(store()).names(), std::vector<std::string>{"box"});
  EXPECT_GT(train(arguments + "obj_000003 --board " + kBoard).exit_code, 100);
  EXPECT_GT(train("--bag " + file("turn.bag")).exit_code, 100);
}

RgbdFrame blankFrame() {
  RgbdFrame frame;
  frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(90));
  frame.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(800));
  frame.color_camera = {640, 480, 525.0, 525.0, 319.5, 239.5};
  return frame;
}

TEST_F(TrainWithoutBoard, SaysWhatTfLacks) {
  const std::string bag = own_ / "blank.bag";
  BagWriter writer(bag, openniTopics(), {"camera"});
  for (int second = 5; second < 8; ++second) writer.write(blankFrame(), second * 1000000000LL);
  writer.close();
  EXPECT_THAT(train("--object-frame cup --bag " + bag).said, testing::AllOf(HasSubstr("no tf"), HasSubstr("'cup'")));

  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  geometry_msgs::TransformStamped& transform = message.transforms.front();
  transform.header.frame_id = "map";
  transform.header.stamp = ros::Time(6.0);
  transform.child_frame_id = "cup";
  transform.transform.rotation.w = 1.0;
  rosbag::Bag(bag, rosbag::bagmode::Append).write("/tf", ros::Time(6.0), message);
  EXPECT_THAT(train("--object-frame cup --bag " + bag).said,
              testing::AllOf(HasSubstr("'cup'"), HasSubstr("'camera'"), HasSubstr("at 5.0")));

  transform.header.frame_id = "camera";
  transform.header.stamp = ros::Time(100.0);
  rosbag::Bag(bag, rosbag::bagmode::Append).write("/tf", ros::Time(6.0), message);
  const ToolRun outside = train("--object-frame cup --bag " + bag);
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_THAT(outside.said, HasSubstr("extrapolation"));
  EXPECT_TRUE(ModelStore(store()).names().empty());
}
#endif

}  // namespace
}  // namespace recognition
