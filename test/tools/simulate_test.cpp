#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "tools/tool_run.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "bags/bag_reader.h"
#include "rgbd_recognition/core/frame.h"
#endif

namespace recognition {
namespace {

using testing::HasSubstr;

const std::string kModels = std::string(RGBD_TEST_DATA) + "/demo/models";
const std::string kBoards = std::string(RGBD_SOURCE_DIR) + "/config/boards/";

ToolRun simulate(const std::string& arguments) { return runTool(RGBD_SIMULATE, arguments); }

class Simulate : public testing::Test {
 protected:
  // One ray a pixel, VGA.
  Simulate() { writeText(directory_ / "fast.yaml", "kinect:\n  color_mode: vga\n  samples: 1\n"); }

  std::string to(const std::string& folder) const {
    return " --sensor " + (directory_ / "fast.yaml") + " --out " + (directory_ / folder);
  }

  TemporaryDirectory directory_;
};

#ifdef RGBD_RECOGNITION_HAS_BAGS
void expectSameFrames(const std::string& bag, const std::vector<BopFrame>& frames) {
  BagReader reader(bag);
  RecordedFrame recorded;
  for (const BopFrame& entry : frames) {
    ASSERT_TRUE(reader.next(&recorded)) << entry.name();
    const RgbdFrame written = loadBopFrame(entry);
    EXPECT_EQ(cv::norm(recorded.frame.color, written.color, cv::NORM_INF), 0.0) << entry.name();
    cv::Mat depth;
    recorded.frame.depth.convertTo(depth, CV_32F, recorded.frame.depth.type() == CV_16UC1 ? 0.001 : 1.0);
    cv::patchNaNs(depth, 0.0);
    EXPECT_LT(cv::norm(depth, written.depth, cv::NORM_INF), 6e-4) << entry.name();
    EXPECT_NEAR(recorded.frame.color_camera.fx, written.color_camera.fx, 1e-9);
    EXPECT_NEAR(recorded.frame.color_camera.cy, written.color_camera.cy, 1e-9);
  }
  EXPECT_FALSE(reader.next(&recorded));
  EXPECT_EQ(reader.skipped(), 0);
}
#endif

struct Recording {
  std::string board;
  std::string layout;
  std::string options;  // of the turntable
  size_t views = 0, views_a_tilt = 0;
};

class SimulateTurntable : public Simulate, public testing::WithParamInterface<Recording> {};

TEST_P(SimulateTurntable, RecordsTheViews) {
  std::string arguments = "turntable --mesh " + kModels + "/obj_000003.ply --unit 0.001 --id 3 --board " + kBoards +
                          GetParam().board + GetParam().options + to("turn");
#ifdef RGBD_RECOGNITION_HAS_BAGS
  arguments += " --bag " + (directory_ / "turn.bag") + " --bag-layout " + GetParam().layout;
#endif
  const ToolRun run = simulate(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.said;
  const std::vector<BopFrame> frames = readBopSplit(directory_ / "turn/train_kinect");
  ASSERT_EQ(frames.size(), GetParam().views);
  for (size_t i = 0; i + 1 < GetParam().views_a_tilt; ++i) {
    const Pose turn =
        frames[i].ground_truth.at(0).camera_from_object.inverse() * frames[i + 1].ground_truth.at(0).camera_from_object;
    EXPECT_NEAR(Eigen::AngleAxisd(turn.linear()).angle(), 2 * M_PI / static_cast<double>(GetParam().views_a_tilt), 1e-6)
        << frames[i].name();
  }
#ifdef RGBD_RECOGNITION_HAS_BAGS
  expectSameFrames(directory_ / "turn.bag", frames);
#endif
}

INSTANTIATE_TEST_SUITE_P(Boards, SimulateTurntable,
                         testing::Values(Recording{"charuco.yaml", "challenge", "", 72, 24},
                                         Recording{"two_checkerboards.yaml", "openni", " --views 10 --tilts 2", 10, 5}),
                         [](const auto& info) { return info.param.layout; });

TEST_F(Simulate, WritesFilmsWithTheTruthOfEachFrame) {
  const ToolRun run = simulate("sequence --models " + kModels +
                               " --objects 2,3 --clutter 0 --path hand --seconds 0.1 --seed 3" + to("film"));
  ASSERT_EQ(run.exit_code, 0) << run.said;
  const std::vector<BopFrame> frames = readBopSplit(directory_ / "film/test_kinect");
  ASSERT_EQ(frames.size(), 3u);
  for (const BopFrame& frame : frames) {
    EXPECT_EQ(frame.scene, 1);
    ASSERT_EQ(frame.ground_truth.size(), 2u);
    EXPECT_EQ(frame.ground_truth[0].object_id, 2);
  }
  EXPECT_GT(
      translationDistance(frames[0].ground_truth[0].camera_from_object, frames[2].ground_truth[0].camera_from_object),
      1e-4);
  EXPECT_THAT(textOf(directory_ / "film/test_kinect/000001/scene_camera.json"), HasSubstr("cam_R_w2c"));
}

TEST_F(Simulate, GoesOnWhereItStoppedAndRefusesOtherSets) {
  const std::string set = "challenge --models " + kModels + " --frames 4 --seed ";
  ASSERT_EQ(simulate(set + "5" + to("set")).exit_code, 0);
  const std::string truth = textOf(directory_ / "set/test_kinect_ground_truth.csv");
  std::filesystem::remove(directory_ / "set/test_kinect_ground_truth.csv");
  const ToolRun again = simulate(set + "5" + to("set"));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.said, HasSubstr("--resume"));
  EXPECT_EQ(simulate(set + "5 --resume" + to("set")).exit_code, 0);
  EXPECT_EQ(textOf(directory_ / "set/test_kinect_ground_truth.csv"), truth);
  const ToolRun other = simulate(set + "6 --resume" + to("set"));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.said, HasSubstr(directory_ / "set"));
}

TEST_F(Simulate, SaysWhatIsWrong) {
  const ToolRun shard = simulate("challenge --shard 4/3 --models " + kModels + to("shard"));
  EXPECT_EQ(shard.exit_code, 1);
  EXPECT_THAT(shard.said, HasSubstr("4/3"));

  const ToolRun unknown = simulate("scene --models " + kModels + " --objects 99" + to("scene"));
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.said, HasSubstr("99"));

  const std::string mesh = directory_ / "obj_000001.ply";
  writeText(mesh, textOf(kModels + "/obj_000001.ply"));  // its texture stays behind
  const ToolRun bare = simulate("scene --models " + directory_.string() + " --objects 1" + to("scene"));
  EXPECT_EQ(bare.exit_code, 1);
  EXPECT_THAT(bare.said, testing::AllOf(HasSubstr("obj_000001"), HasSubstr("missing")));

  const ToolRun huge = simulate("turntable --unit 1000 --mesh " + kModels + "/obj_000003.ply --board " + kBoards +
                                "charuco.yaml" + to("turn"));
  EXPECT_EQ(huge.exit_code, 1);
  EXPECT_THAT(huge.said, testing::AllOf(HasSubstr("obj_000003.ply"), HasSubstr("unit")));

  writeText(mesh,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n0 0 0\n");
  const ToolRun faceless = simulate("scene --models " + directory_.string() + " --objects 1" + to("scene"));
  EXPECT_EQ(faceless.exit_code, 1);
  EXPECT_THAT(faceless.said, HasSubstr("obj_000001.ply"));

  writeText(directory_ / "fast.yaml", "color_sensor:\n  blurr: 1\n");
  const ToolRun sensor = simulate("scene --models " + kModels + " --objects 1" + to("scene"));
  EXPECT_EQ(sensor.exit_code, 1);
  EXPECT_THAT(sensor.said, HasSubstr("blurr"));
}

}  // namespace
}  // namespace recognition
