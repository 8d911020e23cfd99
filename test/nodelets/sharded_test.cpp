// Objects split over several hypothesis_generation nodelets.
#include <gmock/gmock.h>

#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"
#include "ros/hypothesis_shards.h"
#include "ros/message_conversions.h"

namespace recognition {
namespace {

class ShardedTest : public PipelineTest {
 protected:
  /// The second shard, which takes its share of the objects by number unless told which.
  void addShard() {
    setParam("hypothesis_generation_1/shards", 2);
    setParam("hypothesis_generation_1/shard", 1);
    ASSERT_TRUE(loadAs("hypothesis_generation_1", "hypothesis_generation"));
  }

  /// Frames one after the other; expects what one Recognizer with all objects finds. Returns how many objects.
  size_t compare() {
    Recognizer recognizer(RecognizerParameters(), ModelStore(trainedStore()).loadAll().database);
    std::set<std::string> objects;
    for (const FrameMessages& frame : demoFrames()) {
      const RecognitionResult result = recognizer.recognize(frameView(frame));
      const auto found = detect(frame);
      EXPECT_TRUE(found);
      if (!found) break;
      EXPECT_EQ(found->detections.size(), result.detections.size());
      for (const VerifiedHypothesis& should : result.detections)
        objects.insert(expectAmong(found->detections, should, recognizer.database()));
    }
    return objects.size();
  }

 private:
  static std::string expectAmong(const std::vector<messages::Detection>& found, const VerifiedHypothesis& should,
                                 const ModelDatabase& database) {
    const std::string& name = database.objects[static_cast<size_t>(should.hypothesis.object)]->name;
    const bool there = std::any_of(found.begin(), found.end(), [&](const messages::Detection& is) {
      const Pose pose = poseFromMessage(is.pose.pose);
      return is.object == name && translationDistance(pose, should.camera_from_object) < 0.003 &&
             rotationDistance(pose, should.camera_from_object) < 0.02;
    });
    EXPECT_TRUE(there) << name;
    return name;
  }
};

TEST_F(ShardedTest, twoShardsFindWhatOneFinds) {
  setParam("hypothesis_generation/shards", 2);
  setParam("hypothesis_generation/shard_timeout", 20.0);
  loadPipeline();
  addShard();
  waitForCamera();
  EXPECT_EQ(compare(), 2u) << "one object of each shard";
}

TEST_F(ShardedTest, objectsCanBeNamed) {
  setParam("hypothesis_generation/shards", 2);
  setParam("hypothesis_generation/shard_timeout", 20.0);
  setParam("hypothesis_generation/objects", std::vector<std::string>{kSecondObject});
  setParam("hypothesis_generation_1/objects", std::vector<std::string>{kFirstObject});
  loadPipeline();
  addShard();
  waitForCamera();
  EXPECT_EQ(compare(), 2u);
}

TEST_F(ShardedTest, aMissingShardIsToldAndTheOthersGoOn) {
  setParam("hypothesis_generation/shards", 2);
  setParam("hypothesis_generation/shard_timeout", 0.1);
  setParam("hypothesis_generation/objects", std::vector<std::string>{kFirstObject, kSecondObject});
  loadPipeline();
  waitForCamera();
  EXPECT_EQ(compare(), 2u);
  EXPECT_TRUE(diagnosed("hypothesis_generation", "shard 1"));
}

TEST_F(ShardedTest, wrongSharesAreRefused) {
  setParam("models", trainedStore());
  setParam("hypothesis_generation/shards", 2);
  setParam("hypothesis_generation/shard", 2);
  EXPECT_FALSE(load("hypothesis_generation"));
  setParam("hypothesis_generation/shard", 0);
  setParam("hypothesis_generation/objects", std::vector<std::string>{"no_such_object"});
  EXPECT_FALSE(load("hypothesis_generation"));
}

messages::HypothesisArrayPtr resultsOf(int shard, int round, const std::vector<std::string>& objects) {
  const auto results = boost::make_shared<messages::HypothesisArray>();
  results->header.stamp = ros::Time(5.0);
  results->shard = static_cast<std::uint32_t>(shard);
  results->round = static_cast<std::uint32_t>(round);
  for (const std::string& object : objects) {
    results->hypotheses.emplace_back();
    results->hypotheses.back().object = object;
  }
  return results;
}

TEST(ShardResults, MergesByObjectOnceAllAreThere) {
  ShardResults results(2);
  results.expect(ros::Time(5.0), 0);
  EXPECT_THAT(results.missing(), testing::ElementsAre(0, 1));
  results.add(resultsOf(1, 0, {"b", "d"}));
  results.add(resultsOf(1, 0, {"b", "d"}));  // twice
  results.add(resultsOf(1, 1, {"d"}));       // of the next round already
  EXPECT_THAT(results.missing(), testing::ElementsAre(0));
  results.add(resultsOf(0, 0, {"a", "c"}));
  EXPECT_TRUE(results.missing().empty());
  const auto merged = results.merged();
  std::string objects;
  for (const auto& hypothesis : merged->hypotheses) objects += hypothesis.object;
  EXPECT_EQ(objects, "abcd");

  results.expect(ros::Time(5.0), 1);
  EXPECT_THAT(results.missing(), testing::ElementsAre(0));
  results.add(resultsOf(0, 0, {"a"}));  // late
  EXPECT_THAT(results.missing(), testing::ElementsAre(0));
  results.expect(ros::Time(6.0), 0);
  EXPECT_THAT(results.missing(), testing::ElementsAre(0, 1));
}

TEST(ShardObjects, EachObjectIsInOneShard) {
  ModelDatabase all;
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    all.objects.push_back(std::make_shared<ObjectModel>());
    std::const_pointer_cast<ObjectModel>(all.objects.back())->name = name;
  }
  std::set<std::string> names;
  for (int shard = 0; shard < 2; ++shard)
    for (const auto& object : ShardObjects{shard, 2, {}}.select(all).objects)
      EXPECT_TRUE(names.insert(object->name).second);
  EXPECT_EQ(names.size(), 5u);
  EXPECT_EQ((ShardObjects{1, 2, {"e", "a"}}.select(all).objects.size()), 2u);
  EXPECT_THROW((ShardObjects{0, 1, {"x"}}.select(all)), std::invalid_argument);
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "sharded_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
