// Bad messages between the stages, as another node may send them: told with the reason, and the next frame is answered.
#include <algorithm>
#include <functional>
#include <limits>

#include <boost/make_shared.hpp>

#include "nodelets/pipeline_fixture.h"

namespace recognition {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One of the later stages, fed by the test in the place of the stage before it.
class StageTest : public PipelineTest {
 protected:
  /// Good messages of one frame, made by the real stages.
  void SetUp() override {
    loadPipeline();
    const Recorder<messages::Segmentation> segmentation(node_, "hypothesis_generation/segmentation");
    const Recorder<messages::SceneFeatures> features(node_, "hypothesis_generation/features");
    const Recorder<messages::HypothesisArray> hypotheses(node_, "hypothesis_generation/hypotheses");
    waitForCamera();
    ASSERT_TRUE(detect(frame_));
    ASSERT_TRUE(waitFor([&] { return segmentation.at(stamp()) && features.at(stamp()) && hypotheses.at(stamp()); }));
    segmentation_ = *segmentation.at(stamp());
    features_ = *features.at(stamp());
    hypotheses_ = *hypotheses.at(stamp());
  }

  ros::Time stamp() const { return frame_.color->header.stamp; }

  /// Publishes a frame below `stage` as the stage itself would, at a stamp that no other has: synchronisers would mix
  /// them.
  void publishBundle(const std::string& stage, bool with_features) {
    const ros::Time later = stamp() + ros::Duration(10.0 + ++bundles_);
    const FrameMessages frame = withStamp(frame_, later);
    segmentation_.depth_stamp = later;
    segmentation_.header.stamp = features_.header.stamp = hypotheses_.header.stamp = later;
    send(stage + "/color", *frame.color);
    send(stage + "/depth", *frame.depth);
    send(stage + "/camera_info", *frame.camera_info);
    send(stage + "/segmentation", segmentation_);
    if (with_features) send(stage + "/features", features_);
  }

  template <typename Message>
  void send(const std::string& topic, const Message& message) {
    ros::Publisher& publisher = publishers_[topic];
    if (!publisher) publisher = node_.advertise<Message>(topic, 1);
    ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; })) << topic;
    publisher.publish(message);
  }

  /// Sends verification the frame's hypotheses, spoiled, and waits until its diagnostics say so.
  void expectToldOf(const std::function<void(messages::HypothesisArray&)>& spoil, const std::string& told) {
    const messages::HypothesisArray good = hypotheses_;
    spoil(hypotheses_);
    publishBundle("hypothesis_generation", true);
    send("hypothesis_generation/hypotheses", hypotheses_);
    EXPECT_TRUE(diagnosed("reprojection_verification", told)) << told;
    hypotheses_ = good;
  }

  /// Any of the next: how long an answer takes is not known.
  void expectTheNextFrameIsAnswered() {
    const Recorder<messages::DetectionArray>& answers = *recorder_;
    std::vector<ros::Time> next;
    EXPECT_TRUE(waitFor([&] {
      next.push_back(stamp() + ros::Duration(100.0 + static_cast<double>(next.size())));
      publish(withStamp(frame_, next.back()));
      const auto answered = [&](const ros::Time& at) { return answers.at(at) != nullptr; };
      return waitFor([&] { return std::any_of(next.begin(), next.end(), answered); }, 3.0);
    }));
  }

  const FrameMessages frame_ = demoFrames().front();
  messages::Segmentation segmentation_;
  messages::SceneFeatures features_;
  messages::HypothesisArray hypotheses_;
  std::map<std::string, ros::Publisher> publishers_;
  int bundles_ = 0;
  std::unique_ptr<Recorder<messages::DetectionArray>> recorder_ =
      std::make_unique<Recorder<messages::DetectionArray>>(node_, "detections");
};

TEST_F(StageTest, featureExtractionTellsOfBadSegmentations) {
  const messages::Segmentation good = segmentation_;
  segmentation_.patches.clear();
  publishBundle("segmentation", false);
  EXPECT_TRUE(diagnosed("feature_extraction", "and 0 patches"));
  segmentation_ = good;
  segmentation_.labels.data.resize(3);
  publishBundle("segmentation", false);
  EXPECT_TRUE(diagnosed("feature_extraction", "3 bytes, too few"));
  segmentation_ = good;
  for (sensor_msgs::Image* image : {&segmentation_.labels, &segmentation_.edges}) image->height /= 2;
  publishBundle("segmentation", false);
  EXPECT_TRUE(diagnosed("feature_extraction", "labels and edges of"));
  segmentation_ = good;
  segmentation_.labels.encoding = "32FC1";
  publishBundle("segmentation", false);
  EXPECT_TRUE(diagnosed("feature_extraction", "label image has encoding '32FC1'"));
  expectTheNextFrameIsAnswered();
}

TEST_F(StageTest, hypothesisGenerationTellsOfBadFeatures) {
  const messages::SceneFeatures good = features_;
  features_.image.descriptors[5] = kNan;
  publishBundle("feature_extraction", true);
  EXPECT_TRUE(diagnosed("hypothesis_generation", "not finite"));
  features_ = good;
  features_.image.descriptors.clear();
  publishBundle("feature_extraction", true);
  EXPECT_TRUE(diagnosed("hypothesis_generation", "and 0 descriptor values"));  // what the bundle before does not say
  features_ = good;
  features_.image.descriptor = "orb";
  publishBundle("feature_extraction", true);
  EXPECT_TRUE(diagnosed("hypothesis_generation", "orb"));
  features_ = good;
  features_.points[0].x = kNan;
  publishBundle("feature_extraction", true);
  EXPECT_TRUE(diagnosed("hypothesis_generation", "a point that is not finite"));
  expectTheNextFrameIsAnswered();
}

TEST_F(StageTest, verificationTellsOfBadHypotheses) {
  ASSERT_FALSE(hypotheses_.hypotheses.empty());
  const auto expectTold = [&](const std::function<void(messages::Hypothesis&)>& spoil, const std::string& told) {
    expectToldOf([&](messages::HypothesisArray& array) { spoil(array.hypotheses.front()); }, told);
  };
  expectTold([](auto& hypothesis) { hypothesis.object = "teapot"; }, "teapot");
  expectTold([](auto& hypothesis) { hypothesis.pose.orientation = geometry_msgs::Quaternion(); }, "quaternion");
  expectTold([](auto& hypothesis) { hypothesis.pose.position.x = kNan; }, "finite");
  expectTold([](auto& hypothesis) { hypothesis.scene_features.at(0) = 1000000; }, "1000000");
  expectTold([](auto& hypothesis) { hypothesis.model_features.at(0) = -1; }, "-1");
  expectTheNextFrameIsAnswered();
}

TEST_F(StageTest, verificationTellsOfBadMatches) {
  ASSERT_FALSE(hypotheses_.matches.empty());
  const auto expectTold = [&](const std::function<void(messages::ObjectMatches&)>& spoil, const std::string& told) {
    expectToldOf([&](messages::HypothesisArray& array) { spoil(array.matches.front()); }, told);
  };
  expectTold([](auto& matches) { matches.object = "kettle"; }, "kettle");
  expectTold([](auto& matches) { matches.scene_features.at(0) = 2000000; }, "2000000");
  expectTold([](auto& matches) { matches.distances.pop_back(); }, "arrays of different lengths");
  expectTheNextFrameIsAnswered();
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_messages_test");
  const ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
