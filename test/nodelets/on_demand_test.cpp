// Recognition by service, in another frame, within a time budget.
#include <gmock/gmock.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>

#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

std::set<std::string> objectsOf(const messages::DetectionArray& detections) {
  std::set<std::string> names;
  for (const auto& detection : detections.detections) names.insert(detection.object);
  return names;
}

class OnDemandTest : public PipelineTest {
 protected:
  void loadStages(const std::string& models = trainedStore()) {
    setParam("models", models);
    for (const char* name :
         {"segmentation", "feature_extraction", "hypothesis_generation", "reprojection_verification", "on_demand"})
      ASSERT_TRUE(load(name)) << name;
  }

  messages::Detect::Response detect(const std::vector<std::string>& objects, double timeout) {
    messages::Detect call;
    call.request.objects = objects;
    call.request.timeout = timeout;
    EXPECT_TRUE(ros::service::call(ns_ + "/detect", call));
    return call.response;
  }

  bool trigger(const std::string& name) {
    std_srvs::Trigger call;
    EXPECT_TRUE(ros::service::call(ns_ + "/" + name, call)) << name;
    return call.response.success != 0;
  }

  std::unique_ptr<RunningCamera> runCamera(double seconds_behind = 0.0) {
    return std::make_unique<RunningCamera>([this](const FrameMessages& frame) { publish(frame); }, seconds_behind);
  }
};

TEST_F(OnDemandTest, answersWithTheObjectsAskedFor) {
  loadStages();
  const auto camera = runCamera();
  const ros::Time asked = ros::Time::now();
  const auto all = detect({}, 60.0);
  ASSERT_TRUE(all.success) << all.message;
  EXPECT_GE(all.result.header.stamp, asked) << "a frame from before the call";
  EXPECT_THAT(objectsOf(all.result), ::testing::IsSupersetOf({std::string(kFirstObject), std::string(kSecondObject)}));
  const auto one = detect({kSecondObject}, 60.0);
  EXPECT_THAT(objectsOf(one.result), ::testing::ElementsAre(kSecondObject));
  EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 0; })) << "still at work after the answer";
}

TEST_F(OnDemandTest, answersWhateverTheClockOfTheCameraSays) {
  loadStages();
  for (const double behind : {30.0, -30.0, 7200.0}) {
    SCOPED_TRACE(behind);
    const auto camera = runCamera(behind);
    const ros::WallTime asked = ros::WallTime::now();
    const auto answer = detect({}, 25.0);
    ASSERT_TRUE(answer.success) << answer.message;
    EXPECT_GE(answer.result.arrived.toSec(), asked.toSec());
    EXPECT_NEAR((answer.result.arrived - answer.result.header.stamp).toSec(), behind, 5.0);
  }
}

// A listener that leaves takes a frame with it that is on its way; whoever comes next must not wait for that frame.
TEST_F(OnDemandTest, oneAfterAnotherIsAnsweredWithoutWaitingForALostFrame) {
  loadStages();
  const auto camera = runCamera();
  for (int call = 0; call < 12; ++call) {
    SCOPED_TRACE(call);
    const auto answer = detect({}, 25.0);
    ASSERT_TRUE(answer.success) << answer.message;
  }
}

TEST_F(OnDemandTest, twoAtOnceAreAnsweredOneAfterAnother) {
  loadStages();
  ASSERT_TRUE(trigger("stop"));
  const auto camera = runCamera();
  messages::Detect::Response first, second;
  std::thread other([&] { first = detect({kFirstObject}, 60.0); });
  second = detect({kSecondObject}, 60.0);
  other.join();
  ASSERT_TRUE(first.success && second.success) << first.message << second.message;
  EXPECT_THAT(objectsOf(first.result), ::testing::ElementsAre(kFirstObject));
  EXPECT_THAT(objectsOf(second.result), ::testing::ElementsAre(kSecondObject));
  EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 0; })) << "works on after the two frames";
}

TEST_F(OnDemandTest, withoutModelsItSaysSo) {
  const std::string folder = emptyFolder();
  loadStages(folder);
  const auto camera = runCamera();
  const auto answer = detect({}, 5.0);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, ::testing::HasSubstr(folder + " holds no models"));
}

TEST_F(OnDemandTest, namesAnUnknownObject) {
  loadStages();
  const auto answer = detect({"teapot"}, 1.0);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, ::testing::HasSubstr("no model named 'teapot'"));
}

TEST_F(OnDemandTest, tellsWhenNoFrameComes) {
  loadStages();
  const auto answer = detect({}, 0.3);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, ::testing::HasSubstr("no frame was answered"));
  EXPECT_THAT(detect({}, -1.0).message, ::testing::HasSubstr("timeout -1"));
}

TEST_F(OnDemandTest, stopsStartsAndAnswersWhileStopped) {
  loadStages();
  const Recorder<messages::DetectionArray> listener(node_, "detections");
  waitForCamera();
  ASSERT_TRUE(trigger("stop"));
  EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 0; })) << "works though stopped";
  EXPECT_TRUE(diagnosed("segmentation", "stopped"));
  {
    const auto camera = runCamera();
    EXPECT_TRUE(detect({}, 60.0).success);
  }
  EXPECT_TRUE(waitFor([this] { return color_.getNumSubscribers() == 0; })) << "works on after the one frame";
  ASSERT_TRUE(trigger("start"));
  waitForCamera();
}

TEST_F(OnDemandTest, canBeStoppedFromTheBeginning) {
  setParam("segmentation/enabled", false);
  loadStages();
  const Recorder<messages::DetectionArray> listener(node_, "detections");
  EXPECT_TRUE(diagnosed("segmentation", "stopped"));
  EXPECT_EQ(color_.getNumSubscribers(), 0u);
}

TEST_F(OnDemandTest, reloadsTheModelsOfAllStages) {
  const std::string folder = emptyFolder();
  const ModelStore from(trainedStore()), to(folder);
  to.save(from.load(kSecondObject));
  loadStages(folder);
  EXPECT_THAT(detect({kFirstObject}, 1.0).message, ::testing::HasSubstr("no model named"));
  to.save(from.load(kFirstObject));
  EXPECT_TRUE(trigger("reload"));
  const auto camera = runCamera();
  const auto found = detect({kFirstObject}, 60.0);
  EXPECT_THAT(objectsOf(found.result), ::testing::ElementsAre(kFirstObject)) << found.message;
}

class TargetFrameTest : public OnDemandTest {
 protected:
  void SetUp() override {
    target_ = "base" + ns_.substr(1);
    setParam("reprojection_verification/target_frame", target_);
    loadStages();
    detections_ = std::make_unique<Recorder<messages::DetectionArray>>(node_, "detections");
    tf_ = node_.advertise<tf2_msgs::TFMessage>("/tf", 10);
    waitForCamera();
    ASSERT_TRUE(waitFor([this] { return tf_.getNumSubscribers() > 0; }));
  }

  /// The camera 1 m over the target frame, looking down its x axis.
  void publishTf(const ros::Time& stamp, const std::string& camera) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    auto& transform = message.transforms.front();
    transform.header.stamp = stamp;
    transform.header.frame_id = target_;
    transform.child_frame_id = camera;
    transform.transform.translation.z = 1.0;
    transform.transform.rotation.x = -0.5, transform.transform.rotation.y = 0.5;
    transform.transform.rotation.z = -0.5, transform.transform.rotation.w = 0.5;
    tf_.publish(message);
  }

  const FrameMessages frame_ = demoFrames().front();
  std::string target_;
  ros::Publisher tf_;
  std::unique_ptr<Recorder<messages::DetectionArray>> detections_;
};

TEST_F(TargetFrameTest, resultsComeInIt) {
  const ros::Time stamp = ros::Time::now();
  const auto answered = [&] {
    publishTf(stamp - ros::Duration(1.0), frame_.color->header.frame_id);
    publishTf(stamp + ros::Duration(1.0), frame_.color->header.frame_id);
    publish(withStamp(frame_, stamp));
    return waitFor([&] { return detections_->at(stamp) != nullptr; }, 2.0);
  };
  ASSERT_TRUE(waitFor(answered));
  const auto found = detections_->at(stamp);
  EXPECT_EQ(found->header.frame_id, target_);
  ASSERT_FALSE(found->detections.empty());
  for (const auto& detection : found->detections) {
    EXPECT_NEAR(detection.pose.pose.position.x, 1.05, 0.25) << "depth lies along the target's x axis";
    EXPECT_LT(detection.pose.pose.position.z, 1.0) << "below the camera";
  }
}

TEST_F(TargetFrameTest, tellsThatTfIsMissing) {
  publish(withStamp(frame_, ros::Time::now()));
  EXPECT_TRUE(diagnosed("reprojection_verification", "tf does not connect them"));
  EXPECT_EQ(detections_->count(), 0u) << "a result in another frame than was asked for";
}

TEST_F(TargetFrameTest, tellsThatTfIsStale) {
  const ros::Time stamp = ros::Time::now();
  const auto told = [&] {
    publishTf(stamp - ros::Duration(3.0), frame_.color->header.frame_id);
    publish(withStamp(frame_, stamp));
    return diagnosed("reprojection_verification", "tf is stale: its newest transform is 3.000 s older", 2.0);
  };
  EXPECT_TRUE(waitFor(told));
}

TEST_F(PipelineTest, aSmallBudgetLeavesOutWorkAndSaysSo) {
  setParam("reprojection_verification/budget_ms", 1.0);
  loadPipeline();
  waitForCamera();
  const FrameMessages frame = demoFrames().front();
  ASSERT_TRUE(PipelineTest::detect(withStamp(frame, ros::Time(10.0))));
  const auto second = PipelineTest::detect(withStamp(frame, ros::Time(11.0)));  // what a hypothesis costs is known now
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->left_out.empty());
  EXPECT_FALSE(second->detections.empty()) << "the best hypotheses are tested however late it is";
  EXPECT_TRUE(diagnosed("reprojection_verification", "budget overruns="));
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "on_demand_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
