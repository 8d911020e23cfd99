// The tracking nodelet, fed with detections.
#include <limits>

#include <gmock/gmock.h>
#include <tf2_msgs/TFMessage.h>

#include "nodelets/pipeline_fixture.h"
#include "rgbd_recognition/ros/message_conversions.h"

namespace recognition {
namespace {

messages::DetectionArray detectionsAt(double time, const std::vector<double>& xs) {
  messages::DetectionArray array;
  array.header.stamp = ros::Time(time);
  array.header.frame_id = "camera";
  for (const double x : xs) {
    messages::Detection detection;
    detection.object = "can";
    detection.accepted = 1;
    detection.confidence = 0.9;
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(x, 0.0, 1.0);
    detection.pose.pose = poseMessage(pose);
    for (int i = 0; i < 6; ++i) detection.pose.covariance[7 * i] = 1e-4;
    array.detections.push_back(detection);
  }
  return array;
}

class TrackingTest : public PipelineTest {
 protected:
  void start() {
    ASSERT_TRUE(load("tracking"));
    input_ = node_.advertise<messages::DetectionArray>("detections", 5);
    tracks_ = std::make_unique<Recorder<messages::TrackArray>>(node_, "tracks");
    ASSERT_TRUE(waitFor([this] { return input_.getNumSubscribers() > 0; }));
  }

  messages::TrackArrayConstPtr follow(const messages::DetectionArray& detections) {
    input_.publish(detections);
    waitFor([&] { return tracks_->at(detections.header.stamp) != nullptr; }, 10.0);
    return tracks_->at(detections.header.stamp);
  }

  ros::Publisher input_;
  std::unique_ptr<Recorder<messages::TrackArray>> tracks_;
};

TEST_F(TrackingTest, keepsInstanceNumbersAndTellsWhatIsNewAndLost) {
  setParam("tracking/lost_after", 0.5);
  start();
  ASSERT_TRUE(follow(detectionsAt(100.0, {-0.2, 0.2})));
  const auto second = follow(detectionsAt(100.1, {0.2, -0.2}));
  ASSERT_TRUE(second);
  ASSERT_EQ(second->found.size(), 2u);
  const auto third = follow(detectionsAt(100.2, {0.2}));
  ASSERT_TRUE(third);
  ASSERT_EQ(third->tracks.size(), 2u);
  EXPECT_EQ(third->tracks[1].instance, 1u);
  EXPECT_NEAR(third->tracks[1].pose.pose.position.x, 0.2, 1e-3);
  const auto last = follow(detectionsAt(101.0, {0.2}));
  ASSERT_TRUE(last);
  ASSERT_EQ(last->lost.size(), 1u);
  EXPECT_EQ(last->lost[0].instance, 0u);
}

TEST_F(TrackingTest, followsInTheFixedFrame) {
  setParam("tracking/fixed_frame", "map");
  start();
  ros::Publisher tf = node_.advertise<tf2_msgs::TFMessage>("/tf", 5);
  ASSERT_TRUE(waitFor([&] { return tf.getNumSubscribers() > 0; }));
  const auto publishCameraAt = [&](double time, double x) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = ros::Time(time);
    message.transforms[0].header.frame_id = "map";
    message.transforms[0].child_frame_id = "camera";
    message.transforms[0].transform.translation.x = x;
    message.transforms[0].transform.rotation.w = 1.0;
    tf.publish(message);
  };
  publishCameraAt(100.0, 5.0);
  ASSERT_TRUE(waitFor([&] { return follow(detectionsAt(100.0, {0.0})) != nullptr; }));
  publishCameraAt(101.0, 5.3);  // the camera moved, the object did not
  const auto moved = follow(detectionsAt(101.0, {-0.3}));
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->header.frame_id, "map");
  ASSERT_EQ(moved->tracks.size(), 1u);
  EXPECT_NEAR(moved->tracks[0].pose.pose.position.x, 5.0, 1e-6);
}

TEST_F(TrackingTest, knowsWhatIsInViewOfACameraWhoseDetectionsComeInTheRobotsFrame) {
  setParam("tracking/camera_frame", "camera_optical");
  setParam("tracking/lost_after", 0.5);
  start();
  ros::Publisher tf = node_.advertise<tf2_msgs::TFMessage>("/tf", 5);
  ASSERT_TRUE(waitFor([&] { return tf.getNumSubscribers() > 0; }));
  const auto publishCameraTurned = [&](double time, double y, double w) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = ros::Time(time);
    message.transforms[0].header.frame_id = "camera";
    message.transforms[0].child_frame_id = "camera_optical";
    message.transforms[0].transform.rotation.y = y;
    message.transforms[0].transform.rotation.w = w;
    tf.publish(message);
  };
  publishCameraTurned(100.0, 0.0, 1.0);
  ASSERT_TRUE(waitFor([&] { return follow(detectionsAt(100.0, {0.0})) != nullptr; }));
  publishCameraTurned(100.1, 0.0, 1.0);
  ASSERT_TRUE(follow(detectionsAt(100.1, {0.0})));
  publishCameraTurned(101.0, 1.0, 0.0);  // it looks back
  const auto away = follow(detectionsAt(101.0, {}));
  ASSERT_TRUE(away);
  EXPECT_EQ(away->tracks.size(), 1u);
  publishCameraTurned(102.0, 0.0, 1.0);
  const auto back = follow(detectionsAt(102.0, {}));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->lost.size(), 1u);
}

TEST_F(TrackingTest, aDetectionWithoutFiniteCovarianceIsTold) {
  start();
  messages::DetectionArray bad = detectionsAt(100.0, {0.0});
  bad.detections[0].pose.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  input_.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "covariance that is not finite"));
  bad = detectionsAt(100.1, {0.0});
  bad.detections[0].confidence = 2.0f;
  input_.publish(bad);
  EXPECT_TRUE(diagnosed("tracking", "has confidence 2"));
}

TEST_F(TrackingTest, saysWhatIsWrong) {
  setParam("tracking/fixed_frame", "map");
  start();
  input_.publish(detectionsAt(100.0, {0.0}));
  EXPECT_TRUE(diagnosed("tracking", "map"));
}

TEST_F(TrackingTest, refusesUnknownAndWrongParameters) {
  setParam("tracking/confirm_frame", 2);
  EXPECT_FALSE(load("tracking"));
  ros::param::del(ns_ + "/tracking/confirm_frame");
  setParam("tracking/confirm_frames", std::string("two"));
  EXPECT_FALSE(load("tracking"));
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "tracking_test");
  return RUN_ALL_TESTS();
}
