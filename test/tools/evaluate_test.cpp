#include <algorithm>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "tools/tool_run.h"

namespace recognition {
namespace {

using testing::HasSubstr;

const std::string kDemo = std::string(RGBD_TEST_DATA) + "/demo";
const std::string kConfigs = std::string(RGBD_SOURCE_DIR) + "/config/";

/// Two of the demo's objects, trained with few views: enough to find them.
class Evaluate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    store_ = new TemporaryDirectory;
    const ToolRun train = runTool(RGBD_TRAIN, "--models " + store_->string() + " --bop " + kDemo +
                                                  "/models --no-self-test --objects 2,3 --distances 1 --views 30");
    ASSERT_EQ(train.exit_code, 0) << train.said;
  }
  static void TearDownTestSuite() { delete store_; }

  ToolRun evaluate(const std::string& arguments) const {
    return runTool(RGBD_EVALUATE, "--models " + store_->string() + " --bop " + kDemo + "/test_primesense --out " +
                                      (directory_ / "out") + " " + arguments);
  }

  nlohmann::json report() const { return nlohmann::json::parse(textOf(directory_ / "out/report.json")); }

  static TemporaryDirectory* store_;
  TemporaryDirectory directory_;
};
TemporaryDirectory* Evaluate::store_ = nullptr;

TEST_F(Evaluate, ReportsScoreCurvesAndWorstFrames) {
  const ToolRun run =
      evaluate("--only-trained --config " + kConfigs + "default.yaml --config " + kConfigs + "paper.yaml");
  ASSERT_EQ(run.exit_code, 0) << run.said;
  EXPECT_THAT(run.said, HasSubstr("score"));
  const std::string markdown = textOf(directory_ / "out/report.md");
  for (const char* part :
       {"| default.yaml | 3 |", "| paper.yaml | 3 |", "Where instances are lost", "few_correspondences",
        "What false detections lie on", "sweep.png", "Objects (default.yaml)", "003_cracker_box",
        "Visibility (paper.yaml)", "Distance (default.yaml)", "Worst frames (paper.yaml)"})
    EXPECT_THAT(markdown, HasSubstr(part));
  for (const char* file : {"sweep.png", "default/report.json", "default/sweep.csv", "default/results_challenge.csv",
                           "default/results_bop19.csv", "paper/frames.jsonl"})
    EXPECT_TRUE(std::filesystem::exists(directory_ / ("out/" + std::string(file)))) << file;
}

/// The paper's features and configuration, from training to the report.
TEST_F(Evaluate, PaperConfigurationFindsEveryInstance) {
  const std::string store = directory_ / "store", config = " --config " + kConfigs + "paper.yaml";
  const ToolRun train =
      runTool(RGBD_TRAIN, "--models " + store + " --bop " + kDemo + "/models --no-self-test" + config +
                              " --descriptors surf128 --objects 2,3 --distances 2 --views 30");
  ASSERT_EQ(train.exit_code, 0) << train.said;
  const ToolRun run = runTool(RGBD_EVALUATE, "--models " + store + " --bop " + kDemo + "/test_primesense --out " +
                                                 (directory_ / "out") + " --only-trained" + config);
  ASSERT_EQ(run.exit_code, 0) << run.said;
  EXPECT_EQ(report()["true_positives"], report()["instances"]);
  EXPECT_EQ(report()["instances"], 6);
  EXPECT_EQ(report()["false_positives"], 0);
  EXPECT_EQ(report()["within_3cm_20deg"], 6);
}

TEST_F(Evaluate, FollowsEachSceneAsAFilm) {
  const ToolRun run = evaluate("--only-trained --sequence --rate 15 --search-seconds 0.05");
  ASSERT_EQ(run.exit_code, 0) << run.said;
  EXPECT_THAT(run.said, HasSubstr("tracking: 3 frames"));
  EXPECT_THAT(run.said, HasSubstr("detection alone: 3 frames"));
  const auto report = nlohmann::json::parse(textOf(directory_ / "out/sequence.json"));
  EXPECT_EQ(report.at("tracking").at("frames"), 3);
  EXPECT_EQ(report.at("tracking").at("false_tracks"), 0);
  EXPECT_EQ(report.at("tracking").at("poses"), report.at("detection_alone").at("poses"));
}

TEST_F(Evaluate, GoesOnWithoutMissingImagesAndRefusesASplitWithoutTruth) {
  namespace fs = std::filesystem;
  const fs::path split = directory_ / "test_primesense";
  fs::copy(kDemo + "/test_primesense", split, fs::copy_options::recursive);
  fs::remove(split / "000001/depth/000001.png");
  const std::string arguments =
      "--models " + store_->string() + " --bop " + split.string() + " --only-trained --out " + (directory_ / "out");
  ToolRun run = runTool(RGBD_EVALUATE, arguments);
  EXPECT_EQ(run.exit_code, 0) << run.said;
  EXPECT_THAT(run.said, HasSubstr("left out, as files are missing: 1 (000001/000001: no depth image"));
  EXPECT_TRUE(fs::exists(directory_ / "out/report.json"));
  writeText(split / "000001/rgb/000000.png", "no image");
  run = runTool(RGBD_EVALUATE, arguments);
  EXPECT_EQ(run.exit_code, 0) << run.said;
  EXPECT_THAT(run.said, HasSubstr("000000.png: cannot be read as an image; frame left out"));
  for (const char* scene : {"000001", "000054"}) fs::remove(split / scene / "scene_gt.json");
  run = runTool(RGBD_EVALUATE, arguments);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.said, HasSubstr("has no ground truth"));
}

TEST_F(Evaluate, NamesModelsThatShareAnId) {
  const ModelStore store(store_->string());
  ObjectModel twin = store.load("003_cracker_box");
  twin.name = "twin";
  store.save(twin);
  const ToolRun run = evaluate("--only-trained --frames 1");
  store.remove("twin");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.said, HasSubstr("003_cracker_box and twin share the challenge id"));
}

TEST_F(Evaluate, CurveHasTheRunsFiguresAtItsThreshold) {
  ASSERT_EQ(evaluate("--only-trained").exit_code, 0);
  EXPECT_GT(report()["true_positives"].get<int>(), 1);
  const std::string curve = textOf(directory_ / "out/sweep.csv");
  char line[32];
  std::snprintf(line, sizeof line, "\n%.3f,%.3f,", VerificationParameters().min_confidence,
                report()["score_percent"].get<double>());
  EXPECT_THAT(curve, HasSubstr(line));
  EXPECT_EQ(std::count(curve.begin(), curve.end(), '\n'), 52);
}

TEST_F(Evaluate, GoesOnWhereItStopped) {
  ASSERT_EQ(evaluate("--only-trained --jobs 2").exit_code, 0);
  const std::string whole = textOf(directory_ / "out/frames.jsonl");
  const double score = report()["score"].get<double>();
  ASSERT_EQ(std::count(whole.begin(), whole.end(), '\n'), 3);
  writeText(directory_ / "out/frames.jsonl", whole.substr(0, whole.find('\n') + 1) + "{\"scene\": 1, \"fra");
  const ToolRun resumed = evaluate("--only-trained --resume");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.said;
  EXPECT_EQ(report()["frames"].get<int>(), 3);
  EXPECT_DOUBLE_EQ(report()["score"].get<double>(), score);

  const ToolRun other = evaluate("--only-trained --resume --config " + kConfigs + "paper.yaml");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.said, HasSubstr("run.yaml"));
}

TEST_F(Evaluate, ThreeShardsMakeOneReport) {
  ASSERT_EQ(evaluate("--only-trained").exit_code, 0);
  const nlohmann::json whole = report();
  const auto shared = [&](const std::string& arguments) {
    return runTool(RGBD_EVALUATE, "--models " + store_->string() + " --bop " + kDemo + "/test_primesense --out " +
                                      (directory_ / "shared") + " --only-trained " + arguments);
  };
  ASSERT_EQ(shared("--shard 3/3").exit_code, 0);
  ASSERT_EQ(shared("--shard 1/3").exit_code, 0);
  const ToolRun early = shared("--merge");
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.said, HasSubstr("1 of 3 frames"));
  ASSERT_EQ(shared("--shard 2/3").exit_code, 0);
  EXPECT_EQ(shared("--shard 2/3 --config " + kConfigs + "paper.yaml").exit_code, 1);
  const ToolRun merged = shared("--merge");
  ASSERT_EQ(merged.exit_code, 0) << merged.said;
  const nlohmann::json joined = nlohmann::json::parse(textOf(directory_ / "shared/report.json"));
  for (const char* key : {"frames", "instances", "true_positives", "false_positives", "score", "pose_accuracy",
                          "causes", "per_object", "per_distance"})
    EXPECT_EQ(joined[key], whole[key]) << key;
  EXPECT_EQ(textOf(directory_ / "shared/sweep.csv"), textOf(directory_ / "out/sweep.csv"));
  EXPECT_THAT(shared("--shard 0/3").said, HasSubstr("0/3"));
}

TEST_F(Evaluate, NamesObjectsThatHaveNoModel) {
  const ToolRun run = evaluate("");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.said, testing::AllOf(HasSubstr("ground truth names object"), HasSubstr("000001/")));
}

TEST_F(Evaluate, NamesMissingData) {
  const ToolRun split = runTool(RGBD_EVALUATE, "--models " + store_->string() + " --bop " + directory_.string() +
                                                   " --out " + (directory_ / "out"));
  EXPECT_EQ(split.exit_code, 1);
  EXPECT_THAT(split.said, HasSubstr("no scene folders"));
  const ToolRun store = runTool(RGBD_EVALUATE, "--models " + directory_.string() + " --bop " + kDemo +
                                                   "/test_primesense --out " + (directory_ / "out"));
  EXPECT_EQ(store.exit_code, 1);
  EXPECT_THAT(store.said, HasSubstr("holds no model"));
}

}  // namespace
}  // namespace recognition
