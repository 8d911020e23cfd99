// The tracking nodelet beside the pipeline, with frames of the demo as a film.
#include <limits>

#include <gmock/gmock.h>
#include <tf2_msgs/TFMessage.h>

#include "nodelets/pipeline_fixture.h"
#include "ros/message_conversions.h"

namespace recognition {
namespace {

constexpr double kPeriod = 0.1;  // seconds between frames
const std::map<std::string, std::string> kRemapped = {{"detections", "reprojection_verification/detections"}};

class TrackingTest : public PipelineTest {
 protected:
  void start() {
    setParam("models", trainedStore());
    setParam("reprojection_verification/publish_tf", false);
    for (const char* name : {"segmentation", "feature_extraction", "hypothesis_generation"}) ASSERT_TRUE(load(name));
    std::map<std::string, std::string> remapped;
    for (const auto& [from, to] : kRemapped) remapped[ns_ + "/" + from] = ns_ + "/" + to;
    ASSERT_TRUE(load("reprojection_verification", remapped));
    ASSERT_TRUE(load("tracking"));
    tracks_ = std::make_unique<Recorder<messages::TrackArray>>(node_, "tracks");
    detections_ = std::make_unique<Recorder<messages::DetectionArray>>(node_, "detections");
    tf_ = std::make_unique<Recorder<messages::DetectionArray>>(node_, "reprojection_verification/detections");
    waitForCamera();
    ASSERT_TRUE(waitFor([this] { return tracks_->connected() && detections_->connected(); }));
  }

  /// The next frame of the film; its tracks, or null.
  messages::TrackArrayConstPtr show(const FrameMessages& frame) {
    stamp_ += ros::Duration(kPeriod);
    publish(withStamp(frame, stamp_));
    waitFor([&] { return tracks_->at(stamp_) != nullptr; }, 5.0);
    return tracks_->at(stamp_);
  }

  /// Shows a frame until there are tracks; those.
  messages::TrackArrayConstPtr showUntilFound(const FrameMessages& frame, size_t count) {
    messages::TrackArrayConstPtr last;
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(60.0);
    while (ros::WallTime::now() < end) {
      last = show(frame);
      if (last && last->tracks.size() >= count) break;
      ros::WallDuration(0.05).sleep();
    }
    return last;
  }

  ros::Time stamp_{1000.0};
  std::unique_ptr<Recorder<messages::TrackArray>> tracks_;
  std::unique_ptr<Recorder<messages::DetectionArray>> detections_, tf_;
};

TEST_F(TrackingTest, answersEachFrameWithLastingNumbersAndRestsTheStages) {
  start();
  const FrameMessages frame = demoFrames()[0];
  const auto found = showUntilFound(frame, 1);
  ASSERT_TRUE(found);
  ASSERT_FALSE(found->tracks.empty());
  const messages::Track first = found->tracks.front();
  EXPECT_EQ(first.frame, first.object + "_0");
  EXPECT_EQ(first.state, "seen");
  for (int i = 0; i < 20; ++i) {
    const auto next = show(frame);
    ASSERT_TRUE(next) << "frame " << i << " has no answer";
    ASSERT_FALSE(next->tracks.empty());
    EXPECT_EQ(next->tracks.front().object, first.object);
    EXPECT_EQ(next->tracks.front().instance, first.instance);
    EXPECT_NEAR(next->tracks.front().pose.pose.position.z, first.pose.pose.position.z, 0.005);
    ASSERT_TRUE(waitFor([&] { return detections_->at(stamp_) != nullptr; }, 5.0));
    const auto detections = detections_->at(stamp_);
    ASSERT_FALSE(detections->detections.empty());
    EXPECT_FALSE(detections->detections.front().frame.empty());
    EXPECT_GT(detections->arrived.toSec(), 0.0);
    if (i == 0) continue;
    EXPECT_EQ(detections->detections.front().source, "track");
  }
  EXPECT_TRUE(waitFor(
      [&] {
        show(frame);
        return largestDiagnosed("segmentation", "frames without change") > 0.0;
      },
      30.0));
}

TEST_F(TrackingTest, tellsWhatIsLostAndWhy) {
  start();
  const std::vector<FrameMessages> frames = demoFrames();
  const auto found = showUntilFound(frames[0], 1);
  ASSERT_TRUE(found);
  ASSERT_FALSE(found->tracks.empty());
  FrameMessages empty = frames[0];
  const auto wall = boost::make_shared<sensor_msgs::Image>(*frames[0].depth);
  ASSERT_EQ(wall->encoding, "16UC1");
  for (size_t i = 0; i + 1 < wall->data.size(); i += 2) wall->data[i] = 0xa0, wall->data[i + 1] = 0x0f;  // 4 m
  empty.depth = wall;
  std::vector<messages::Track> lost;
  for (int i = 0; i < 20 && lost.empty(); ++i) {
    const auto answer = show(empty);
    ASSERT_TRUE(answer);
    lost = answer->lost;
  }
  ASSERT_FALSE(lost.empty());
  EXPECT_EQ(lost.front().reason, "taken_away");
}

TEST_F(TrackingTest, aClockThatIsSetBackListsTheTracksAsLost) {
  start();
  const FrameMessages frame = demoFrames()[0];
  const auto found = showUntilFound(frame, 1);
  ASSERT_TRUE(found);
  ASSERT_FALSE(found->tracks.empty());
  stamp_ = ros::Time(10.0);
  const auto answer = show(frame);
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->tracks.empty());
  ASSERT_EQ(answer->lost.size(), found->tracks.size());
  EXPECT_EQ(answer->lost.front().reason, "clock_set_back");
  const auto again = showUntilFound(frame, 1);
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->tracks.empty());
}

TEST_F(TrackingTest, doubledFramesAreAnsweredOnce) {
  start();
  const FrameMessages frame = demoFrames()[0];
  ASSERT_TRUE(show(frame));
  const size_t answers = tracks_->count();
  publish(withStamp(frame, stamp_));
  publish(withStamp(frame, stamp_ - ros::Duration(0.5 * kPeriod)));
  ASSERT_TRUE(show(frame));
  EXPECT_EQ(tracks_->count(), answers + 1);
}

TEST_F(TrackingTest, standsInTheFixedFrameThatTfTells) {
  setParam("tracking/fixed_frame", "map");
  start();
  const FrameMessages frame = demoFrames()[0];
  EXPECT_FALSE(show(frame));
  EXPECT_TRUE(diagnosed("tracking", "map"));
  ros::Publisher tf = node_.advertise<tf2_msgs::TFMessage>("/tf_static", 5);
  ASSERT_TRUE(waitFor([&] { return tf.getNumSubscribers() > 0; }));
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.frame_id = "map";
  message.transforms[0].child_frame_id = frame.color->header.frame_id;
  message.transforms[0].transform.translation.x = 5.0;
  message.transforms[0].transform.rotation.w = 1.0;
  tf.publish(message);
  const auto found = showUntilFound(frame, 1);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->header.frame_id, "map");
  ASSERT_FALSE(found->tracks.empty());
  EXPECT_NEAR(found->tracks.front().pose.pose.position.x, 5.0, 1.0);
  ASSERT_TRUE(waitFor([&] { return detections_->at(stamp_) != nullptr; }, 5.0));
  const auto detections = detections_->at(stamp_);
  EXPECT_EQ(detections->header.frame_id, frame.color->header.frame_id);
  EXPECT_LT(detections->detections.at(0).pose.pose.position.x, 1.0);
}

TEST_F(TrackingTest, detectionsThatAreNoneAreTold) {
  start();
  const FrameMessages frame = demoFrames()[0];
  ros::Publisher results = node_.advertise<messages::DetectionArray>("reprojection_verification/detections", 5);
  ASSERT_TRUE(waitFor([&] { return results.getNumSubscribers() > 0; }));
  ASSERT_TRUE(show(frame));
  messages::DetectionArray bad;
  bad.header = frame.color->header;
  bad.detections.resize(1);
  bad.detections[0].object = kFirstObject;
  bad.detections[0].accepted = 1;
  bad.detections[0].source = "consensus";
  bad.detections[0].pose.pose.orientation.w = 1.0;
  bad.detections[0].pose.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  results.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "covariance that is not finite"));
  bad.detections[0].pose.covariance[0] = 0.0;
  bad.detections[0].confidence = 2.0;
  results.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "has confidence 2"));
  bad.detections[0].object = "nothing";
  results.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "no model is named 'nothing'"));
  bad.header.frame_id = "elsewhere";
  results.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "detections come in 'elsewhere'"));
}

TEST_F(TrackingTest, refusesUnknownAndWrongParameters) {
  setParam("models", trainedStore());
  setParam("tracking/confirm_detection", 2);
  EXPECT_FALSE(load("tracking"));
  ros::param::del(ns_ + "/tracking/confirm_detection");
  setParam("tracking/confirm_detections", std::string("two"));
  EXPECT_FALSE(load("tracking"));
  ros::param::del(ns_ + "/tracking/confirm_detections");
  setParam("tracking/lost_after", -1.0);
  EXPECT_FALSE(load("tracking"));
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "tracking_test");
  return RUN_ALL_TESTS();
}
