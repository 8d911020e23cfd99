// The actions beside the services: results, feedback, preemption, more goals than one.
#include <actionlib/client/simple_action_client.h>
#include <gmock/gmock.h>
#include <rgbd_recognition/DetectAction.h>
#include <rgbd_recognition/TrainObject.h>
#include <rgbd_recognition/TrainObjectAction.h>
#include <std_srvs/Trigger.h>

#include "nodelets/box_recording.h"
#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using State = actionlib::SimpleClientGoalState;

const ros::Duration kPatience(240.0);
constexpr int kViews = 8;  // of a training

/// A client that notes the feedback to its goal.
template <typename Action>
class Client {
 public:
  ACTION_DEFINITION(Action)

  Client(const std::string& ns, const std::string& name) : client_(ns + "/" + name, false) {
    EXPECT_TRUE(client_.waitForServer(kPatience)) << ns << "/" << name;
  }

  void send(const Goal& goal) {
    client_.sendGoal(goal, {}, {}, [this](const boost::shared_ptr<const Feedback>& feedback) {
      const std::lock_guard<std::mutex> lock(mutex_);
      feedback_.push_back(*feedback);
    });
  }
  void cancel() { client_.cancelGoal(); }

  /// How the goal ended.
  std::string ended() {
    EXPECT_TRUE(client_.waitForResult(kPatience));
    return client_.getState().toString();
  }
  Result result() { return *client_.getResult(); }

  std::vector<Feedback> feedback() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return feedback_;
  }
  bool isTold() const { return !feedback().empty(); }

 private:
  mutable std::mutex mutex_;  // guards feedback_
  std::vector<Feedback> feedback_;
  actionlib::SimpleActionClient<Action> client_;
};

class DetectActionTest : public PipelineTest {
 protected:
  using Detecting = Client<messages::DetectAction>;

  void SetUp() override {
    setParam("models", trainedStore());
    for (const char* name :
         {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification", "on_demand"})
      ASSERT_TRUE(load(name)) << name;
    goal_.timeout = 60.0;
  }

  std::unique_ptr<RunningCamera> runCamera() {
    return std::make_unique<RunningCamera>([this](const FrameMessages& frame) { publish(frame); });
  }

  messages::DetectGoal goal_;
};

TEST_F(DetectActionTest, answersWithTheObjectsAskedForAndTellsWhereTheFrameIs) {
  Detecting detect(ns_, "detect");
  goal_.objects = {kSecondObject};
  detect.send(goal_);
  ASSERT_TRUE(waitFor([&] { return detect.isTold(); }));
  EXPECT_EQ(detect.feedback().front().stage, "waiting");
  EXPECT_EQ(detect.feedback().front().frames, 0u);
  const auto camera = runCamera();
  EXPECT_EQ(detect.ended(), "SUCCEEDED");
  const auto result = detect.result();
  EXPECT_TRUE(result.success) << result.message;
  ASSERT_EQ(result.result.detections.size(), 1u);
  EXPECT_EQ(result.result.detections[0].object, kSecondObject);
  std::vector<std::string> stages;
  for (const auto& told : detect.feedback()) stages.push_back(told.stage);
  EXPECT_THAT(stages, Contains("segmentation"));
  EXPECT_THAT(stages, Contains("feature_extraction"));
  EXPECT_GT(detect.feedback().back().frames, 0u);
  EXPECT_GT(detect.feedback().back().seconds, 0.0);
}

TEST_F(DetectActionTest, preemptionEndsTheWaitAndClosesTheGate) {
  std_srvs::Trigger stop;
  ASSERT_TRUE(ros::service::call(ns_ + "/stop", stop));
  Detecting detect(ns_, "detect");
  detect.send(goal_);
  ASSERT_TRUE(waitFor([&] { return color_.getNumSubscribers() > 0; })) << "the gate is open while it waits";
  const ros::WallTime cancelled = ros::WallTime::now();
  detect.cancel();
  EXPECT_EQ(detect.ended(), "PREEMPTED");
  EXPECT_LT((ros::WallTime::now() - cancelled).toSec(), 0.5 * goal_.timeout);
  EXPECT_EQ(detect.result().message, "cancelled");
  EXPECT_TRUE(waitFor([&] { return color_.getNumSubscribers() == 0; })) << "works on";
}

TEST_F(DetectActionTest, goalsTakeTurnsAndOneThatWaitsCanBeCancelled) {
  Detecting first(ns_, "detect"), second(ns_, "detect"), third(ns_, "detect");
  goal_.objects = {kFirstObject};
  first.send(goal_);
  ASSERT_TRUE(waitFor([&] { return first.isTold(); }));
  goal_.objects = {kSecondObject};
  second.send(goal_);
  third.send(goal_);
  third.cancel();
  EXPECT_EQ(third.ended(), "RECALLED") << "although the first goal still waits";
  EXPECT_FALSE(second.isTold()) << "before its turn";
  const auto camera = runCamera();
  EXPECT_EQ(first.ended(), "SUCCEEDED");
  EXPECT_EQ(second.ended(), "SUCCEEDED");
  EXPECT_EQ(first.result().result.detections.at(0).object, kFirstObject);
  EXPECT_EQ(second.result().result.detections.at(0).object, kSecondObject);
}

TEST_F(DetectActionTest, saysWhyAGoalFailed) {
  Detecting detect(ns_, "detect");
  goal_.objects = {"teapot"};
  detect.send(goal_);
  EXPECT_EQ(detect.ended(), "ABORTED");
  EXPECT_FALSE(detect.result().success);
  EXPECT_THAT(detect.result().message, HasSubstr("no model named 'teapot'"));
}

class TrainActionTest : public PipelineTest {
 protected:
  using Training = Client<messages::TrainObjectAction>;

  void SetUp() override {
    folder_ = emptyFolder();
    store_ = folder_ + "/store";
    setParam("training/models", store_);
    setParam("training/boards", kBoards);
    ASSERT_TRUE(load("training"));
    bag_.name = "box";
    bag_.source = messages::TrainObjectGoal::BAG;
    bag_.file = writeBag(folder_ + "/turntable.bag", {recording().begin(), recording().begin() + kViews});
    live_.name = "other";
  }

  std::string folder_, store_;
  messages::TrainObjectGoal bag_, live_;
};

TEST_F(TrainActionTest, aModelIsMadeAndTheViewsAreTold) {
  Training train(ns_, "training/train_object");
  train.send(bag_);
  EXPECT_EQ(train.ended(), "SUCCEEDED");
  const auto result = train.result();
  EXPECT_TRUE(result.success) << result.message;
  EXPECT_EQ(result.views_used, size_t(kViews));
  EXPECT_GT(result.points, 1000u);
  EXPECT_THAT(ModelStore(store_).names(), ::testing::ElementsAre("box"));
  const auto told = train.feedback();
  ASSERT_GT(told.size(), size_t(kViews));
  EXPECT_EQ(told.back().progress.stage, "done");
  EXPECT_EQ(told.back().progress.views_used, size_t(kViews));
  EXPECT_GT(told.back().progress.coverage, 0.1);
}

TEST_F(TrainActionTest, preemptionLeavesNoModel) {
  Training train(ns_, "training/train_object");
  train.send(bag_);
  ASSERT_TRUE(waitFor([&] {
    const auto told = train.feedback();
    return !told.empty() && told.back().progress.views_used > 3;
  }));
  train.cancel();
  EXPECT_EQ(train.ended(), "PREEMPTED");
  EXPECT_EQ(train.result().message, "cancelled");
  EXPECT_TRUE(ModelStore(store_).names().empty());
}

TEST_F(TrainActionTest, aSecondGoalIsRefusedAndItsCancelHitsNobodyElse) {
  Training first(ns_, "training/train_object"), second(ns_, "training/train_object");
  first.send(live_);
  ASSERT_TRUE(waitFor([&] { return first.isTold(); }));
  second.send(bag_);
  EXPECT_EQ(second.ended(), "ABORTED");
  EXPECT_THAT(second.result().message, HasSubstr("another training"));
  second.cancel();
  messages::TrainObject call;
  ASSERT_TRUE(ros::service::call(ns_ + "/training/train_object", call));
  EXPECT_THAT(call.response.message, HasSubstr("another training")) << "the first goal was cancelled";
  const ros::WallTime cancelled = ros::WallTime::now();
  first.cancel();
  EXPECT_EQ(first.ended(), "PREEMPTED") << "while it waits for frames";
  EXPECT_LT((ros::WallTime::now() - cancelled).toSec(), 5.0) << "as soon as it can, and not after its patience";
  second.send(bag_);
  EXPECT_EQ(second.ended(), "SUCCEEDED") << second.result().message;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  ros::init(argc, argv, "actions_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
