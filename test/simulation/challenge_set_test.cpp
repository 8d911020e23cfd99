#include "simulation/challenge_set.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "simulation/fixtures.h"

namespace recognition {
namespace {

std::vector<CatalogObject> boxCatalog(int count) {
  std::vector<CatalogObject> catalog;
  for (int i = 0; i < count; ++i) {
    catalog.emplace_back();
    catalog.back().id = i + 1;
    const double size = i < 2 ? 0.1 : 0.1 + 0.02 * i;  // the first two are twins
    catalog.back().shape = convexShape(makeBox({size, 0.05, 0.2}, plainTexture(100)));
  }
  return catalog;
}

struct PlanFigures {
  int instances = 0, empty = 0, with_duplicates = 0, with_twins = 0;
  std::map<int, int> uses;
};

PlanFigures figures(const std::vector<std::vector<int>>& plan) {
  PlanFigures f;
  for (const auto& frame : plan) {
    const std::set<int> kinds(frame.begin(), frame.end());
    f.instances += static_cast<int>(frame.size());
    f.empty += frame.empty();
    f.with_duplicates += kinds.size() < frame.size();
    f.with_twins += kinds.count(0) && kinds.count(1);
    for (const int object : frame) ++f.uses[object];
  }
  return f;
}

TEST(ChallengePlan, HasTheChallengesNumbers) {
  for (const bool nist : {false, true}) {
    const auto set = nist ? ChallengeSetParameters::nist() : ChallengeSetParameters::wg();
    const int objects = nist ? 15 : 35;
    const auto plan = planChallengeSet(set, boxCatalog(objects), 1);
    const PlanFigures f = figures(plan);
    EXPECT_EQ(plan.size(), nist ? 399u : 176u);
    EXPECT_EQ(f.instances, nist ? 831 : 434);
    EXPECT_EQ(f.empty, nist ? 40 : 18);
    EXPECT_GT(f.with_duplicates, 5);
    EXPECT_GT(f.with_twins, 2);
    EXPECT_EQ(f.uses.size(), static_cast<size_t>(objects));
    for (const auto& [object, uses] : f.uses) EXPECT_GT(uses, f.instances / objects / 3) << "object " << object;
  }
}

TEST(ChallengePlan, FollowsFromTheSeed) {
  const auto set = ChallengeSetParameters::wg();
  const auto catalog = boxCatalog(35);
  EXPECT_EQ(planChallengeSet(set, catalog, 3), planChallengeSet(set, catalog, 3));
  EXPECT_NE(planChallengeSet(set, catalog, 3), planChallengeSet(set, catalog, 4));
}

TEST(ChallengePlan, ScalesAndRejects) {
  EXPECT_EQ(ChallengeSetParameters::wg().withFrames(88).instances, 217);
  ChallengeSetParameters impossible;
  impossible.instances = 3;
  EXPECT_THROW(planChallengeSet(impossible, boxCatalog(3), 1), std::invalid_argument);
  EXPECT_THROW(planChallengeSet(ChallengeSetParameters(), {}, 1), std::invalid_argument);
}

// Three box models as a BOP folder.
void writeModels(const std::string& directory) {
  std::filesystem::create_directories(directory);
  cv::RNG rng(7);
  for (int id = 1; id <= 3; ++id)
    writeBopModel(directory, id, makeBox({0.1, 0.06 + 0.03 * id, 0.15}, makePrintTexture({256, 192}, rng)));
}

SetMaking fastMaking(std::uint64_t seed) {
  SetMaking making;
  making.kinect.color_mode = ColorMode::kVga;
  making.kinect.samples = 1;
  making.world.max_clutter = 3;
  making.seed = seed;
  return making;
}

ChallengeSetParameters smallSet(int frames, int instances, int empty) {
  ChallengeSetParameters set;
  set.frames = frames;
  set.instances = instances;
  set.empty_share = static_cast<double>(empty) / frames;
  return set;
}

void writeSet(const TemporaryDirectory& folder, const std::string& out, std::uint64_t seed) {
  writeChallengeSet(smallSet(3, 4, 1), folder / "models", fastMaking(seed), folder / out);
}

TEST(ChallengeSet, SameSeedSameBytesWhateverTheThreadsAndInterruptions) {
  const TemporaryDirectory folder;
  writeModels(folder / "models");
  cv::setNumThreads(1);
  writeSet(folder, "a", 1);
  cv::setNumThreads(2);
  writeSet(folder, "b", 1);
  std::filesystem::remove(folder / "b/test_kinect/.frames/000001.json");  // as if the run had stopped before
  std::filesystem::remove(folder / "b/test_kinect/000001/rgb/000001.png");
  writeSet(folder, "b", 1);
  const std::string scene = "/test_kinect/000001/";
  for (const char* file : {"scene_gt.json", "scene_gt_info.json", "scene_camera.json", "rgb/000000.png",
                           "rgb/000001.png", "depth/000002.png"}) {
    const std::string bytes = readText(folder / ("a" + scene + file));
    EXPECT_FALSE(bytes.empty()) << file;
    EXPECT_TRUE(bytes == readText(folder / ("b" + scene + file))) << file;
  }
  const auto frames = readBopSplit(folder / "a/test_kinect");
  int instances = 0;
  for (const auto& frame : frames)
    for (const auto& truth : frame.ground_truth) {
      ++instances;
      EXPECT_GE(truth.visibility, 0.3);
    }
  EXPECT_EQ(instances, 4);
  EXPECT_TRUE(std::filesystem::exists(folder / "a/models/obj_000003.png"));
}

TEST(ChallengeSet, ThreeShardsMakeWhatOneRunMakes) {
  const TemporaryDirectory folder;
  writeModels(folder / "models");
  const ChallengeSetParameters set = smallSet(4, 4, 1);  // two frames for the first shard
  SetMaking making = fastMaking(3);
  writeChallengeSet(set, folder / "models", making, folder / "whole");
  for (const char* shard : {"3/3", "1/3", "2/3"}) {
    making.shard = Shard::parse(shard);
    writeChallengeSet(set, folder / "models", making, folder / "shared");
  }
  for (const char* file : {"/test_kinect/000001/scene_gt.json", "/test_kinect/000001/scene_camera.json",
                           "/test_kinect/000001/rgb/000003.png", "/test_kinect_ground_truth.csv"})
    EXPECT_TRUE(readText(folder / ("whole" + std::string(file))) == readText(folder / ("shared" + std::string(file))))
        << file;
}

TEST(ChallengeSet, EndsWhereNothingCanBeArranged) {
  const TemporaryDirectory folder;
  writeModels(folder / "models");
  const std::vector<CatalogObject> catalog = loadCatalog(folder / "models");
  SetMaking making = fastMaking(1);
  making.world.tabletop.min_distance = 0.1;
  making.world.tabletop.max_distance = 0.12;  // nearer than a whole object can be seen
  making.world.tabletop.max_attempts = 1;
  std::vector<std::string> said;
  making.log = [&said](const std::string& line) { said.push_back(line); };
  const BopWriter writer(folder / "set", "test_kinect", 50);
  writeTabletops({{0, 1}}, catalog, making, writer);
  const auto frames = readBopSplit(folder / "set/test_kinect");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].ground_truth.empty());
  ASSERT_EQ(said.size(), 4u);  // two other draws, then one object, then none
  EXPECT_NE(said.back().find("frame 0: no arrangement of 1 objects"), std::string::npos) << said.back();
  EXPECT_NE(said.back().find("drawn anew with 0 objects"), std::string::npos) << said.back();
}

TEST(ChallengeSet, OneObjectServesForTheWideWorld) {
  const TemporaryDirectory folder;
  std::filesystem::create_directories(folder / "models");
  cv::RNG rng(7);
  writeBopModel(folder / "models", 4, makeBox({0.1, 0.06, 0.15}, makePrintTexture({256, 192}, rng)));
  SetMaking making = fastMaking(5);
  making.world = World::of(WorldPreset::kWide);
  ChallengeSetParameters set = ChallengeSetParameters::nist().withFrames(6);
  set.empty_share = making.world.empty_share;
  writeChallengeSet(set, folder / "models", making, folder / "set");
  const auto frames = readBopSplit(folder / "set/test_kinect");
  ASSERT_EQ(frames.size(), 6u);
  size_t instances = 0;
  for (const auto& frame : frames) {
    instances += frame.ground_truth.size();
    EXPECT_GT(cv::countNonZero(loadBopFrame(frame).depth > 0.0f), 1000) << frame.name();
    for (const auto& truth : frame.ground_truth) EXPECT_EQ(truth.object_id, 4);
  }
  EXPECT_GT(instances, 5u);
}

TEST(ChallengeSet, RefusesToMixSeedsAndNamesBadModels) {
  const TemporaryDirectory folder;
  writeModels(folder / "models");
  const auto writeOne = [&folder](std::uint64_t seed) {
    writeChallengeSet(smallSet(1, 1, 0), folder / "models", fastMaking(seed), folder / "a");
  };
  writeOne(1);
  EXPECT_THROW(writeOne(2), std::runtime_error);
  std::filesystem::remove(folder / "models/obj_000002.png");
  EXPECT_THROW(loadCatalog(folder / "models"), std::runtime_error);
  EXPECT_THROW(loadCatalog(folder / "nothing"), std::runtime_error);
}

}  // namespace
}  // namespace recognition
