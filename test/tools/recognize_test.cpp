#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "evaluation/result_files.h"
#include "tools/tool_run.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kDemo = std::string(RGBD_TEST_DATA) + "/demo";
const std::string kScene = kDemo + "/test_primesense/000001";

/// One of the demo's objects, trained with few views.
class Recognize : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    store_ = new TemporaryDirectory;
    const ToolRun train =
        runTool(RGBD_TRAIN, "--models " + store_->string() + " --mesh " + kDemo +
                                "/models/obj_000002.ply --unit 0.001 --name box --no-self-test --distances 1 "
                                "--views 30");
    ASSERT_EQ(train.exit_code, 0) << train.said;
  }
  static void TearDownTestSuite() { delete store_; }

  static ToolRun recognize(const std::string& arguments) {
    return runTool(RGBD_RECOGNIZE, "--models " + store_->string() + " " + arguments);
  }
  ToolRun recognizeFiles(const std::string& color, const std::string& depth, const std::string& camera) const {
    return recognize("--color " + color + " --depth " + depth + " --camera " + camera);
  }

  static TemporaryDirectory* store_;
  TemporaryDirectory directory_;
};
TemporaryDirectory* Recognize::store_ = nullptr;

TEST_F(Recognize, WritesEachDetectionWithTheNameOfItsObject) {
  const ToolRun run = recognize("--bop " + kDemo + "/test_primesense --out " + (directory_ / "out"));
  EXPECT_EQ(run.exit_code, 0) << run.said;
  std::ifstream csv(directory_ / "out/detections.csv");
  const auto rows = readChallengeCsv(csv);
  ASSERT_FALSE(rows.empty());
  for (const ResultRow& row : rows) {
    EXPECT_EQ(row.object, "box");
    EXPECT_EQ(row.object_id, 1001);
  }
}

TEST_F(Recognize, TakesTheCameraOfTheFramesOwnNumber) {
  fs::copy(kScene + "/rgb/000001.png", directory_ / "000001.png");
  const ToolRun run =
      recognizeFiles(directory_ / "000001.png", kScene + "/depth/000001.png", kScene + "/scene_camera.json");
  EXPECT_EQ(run.exit_code, 0) << run.said;
  fs::copy(kScene + "/rgb/000001.png", directory_ / "000077.png");
  EXPECT_THAT(
      recognizeFiles(directory_ / "000077.png", kScene + "/depth/000001.png", kScene + "/scene_camera.json").said,
      HasSubstr("has no entry for frame 77"));
}

TEST_F(Recognize, SearchesNoFrameThatCannotBeRight) {
  const std::string color = kScene + "/rgb/000000.png", depth = kScene + "/depth/000000.png";
  writeText(directory_ / "camera.json", R"({"K": [[2133, 0, 626], [0, 2135, 483], [0, 0, 1]], "depth_scale": 0.1})");
  ToolRun run = recognizeFiles(color, depth, directory_ / "camera.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.said, HasSubstr("principal point (626, 483) is outside of the 640x480 picture"));
  EXPECT_THAT(run.said, testing::Not(HasSubstr("0 found")));
  cv::imwrite(directory_ / "empty.png", cv::Mat(480, 640, CV_16UC1, cv::Scalar(0)));
  run = recognizeFiles(color, directory_ / "empty.png", kScene + "/scene_camera.json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.said, HasSubstr("depth image is empty"));
  EXPECT_THAT(run.said, HasSubstr("no frame could be searched"));
  writeText(directory_ / "000001.png", "no image");
  run = recognizeFiles(directory_ / "000001.png", depth, kScene + "/scene_camera.json");
  EXPECT_THAT(run.said, HasSubstr("000001.png: cannot be read as an image"));
  EXPECT_THAT(run.said, testing::Not(HasSubstr("imread")));
  writeText(directory_ / "000001.png", readText(color).substr(0, 50000));
  run = recognizeFiles(directory_ / "000001.png", depth, kScene + "/scene_camera.json");
  EXPECT_THAT(run.said, HasSubstr("000001.png: cannot be read as an image"));
  EXPECT_THAT(run.said, testing::Not(HasSubstr("libpng")));
}

TEST_F(Recognize, GoesOnWithoutMissingImagesAndWithoutTruth) {
  const fs::path split = directory_ / "test";
  fs::copy(kDemo + "/test_primesense", split, fs::copy_options::recursive);
  fs::remove(split / "000001/rgb/000001.png");
  fs::remove(split / "000001/scene_gt.json");
  fs::remove_all(split / "000054");
  const ToolRun run = recognize("--bop " + split.string());
  EXPECT_EQ(run.exit_code, 0) << run.said;
  EXPECT_THAT(run.said, HasSubstr("000001/000000: "));
  EXPECT_THAT(run.said, HasSubstr("left out, as files are missing: 1 (000001/000001: no colour image"));
}

}  // namespace
}  // namespace recognition
