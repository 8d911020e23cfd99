#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "ros/message_conversions.h"

namespace recognition {
namespace {

using ::testing::HasSubstr;

Pose samplePose() {
  Pose pose = Pose::Identity();
  pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.9);
  return pose;
}

ModelDatabase twoModels() {
  ModelDatabase database;
  for (const char* name : {"can", "box"}) {
    auto model = std::make_shared<ObjectModel>();
    model->name = name;
    model->features[DescriptorType::kSurf64].descriptors = cv::Mat::zeros(5, 64, CV_32FC1);
    database.objects.push_back(model);
  }
  return database;
}

SceneFeatures threeFeatures() {
  SceneFeatures features;
  features.image.type = DescriptorType::kSurf64;
  features.image.descriptors = cv::Mat(3, 64, CV_32FC1);
  cv::randu(features.image.descriptors, 0.0f, 1.0f);
  for (int i = 0; i < 3; ++i) {
    features.image.keypoints.push_back({1.5f + i, 2.5f, 9.0f, 0.5f, 100.0f, i == 1});
    features.points.emplace_back(0.1f * i, 0.2f, 0.8f);
  }
  features.without_depth.type = DescriptorType::kSurf64;
  return features;
}

std_msgs::Header someHeader() {
  std_msgs::Header header;
  header.stamp = ros::Time(12, 34);
  header.frame_id = "optical";
  return header;
}

TEST(PoseMessage, comesBackAsItWent) {
  const Pose pose = samplePose(), back = poseFromMessage(poseMessage(pose));
  EXPECT_LT(translationDistance(pose, back), 1e-12);
  EXPECT_LT(rotationDistance(pose, back), 1e-7);
}

TEST(PoseMessage, refusesWhatIsNoPose) {
  auto message = poseMessage(samplePose());
  message.orientation = geometry_msgs::Quaternion();
  EXPECT_THAT(refusal([&] { poseFromMessage(message); }), HasSubstr("quaternion of length 0"));
  message = poseMessage(samplePose());
  message.position.z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([&] { poseFromMessage(message); }), HasSubstr("not finite"));
}

TEST(SegmentationMessage, sharesItsPixelsWithTheView) {
  Segmentation segmentation;
  segmentation.labels = (cv::Mat_<int>(2, 3) << 1, 1, 0, -1, -1, 0);
  segmentation.edges = (cv::Mat_<std::uint8_t>(2, 3) << 0, 1, 2, 3, 0, 0);
  Patch patch;
  patch.label = 1, patch.pixels = 2, patch.box = {0, 0, 2, 1};
  patch.centroid = {0.1f, 0.2f, 0.3f}, patch.eigenvalues = {1e-6f, 2e-5f, 3e-4f},
  patch.axes = samplePose().linear().cast<float>();
  segmentation.patches = {patch};
  const auto message = toMessage(segmentation, someHeader());
  const Segmentation back = fromMessage(*message);
  EXPECT_EQ(message->header.frame_id, "optical");
  EXPECT_EQ(back.labels.data, message->labels.data.data());
  EXPECT_EQ(cv::countNonZero(back.labels != segmentation.labels), 0);
  EXPECT_EQ(cv::countNonZero(back.edges != segmentation.edges), 0);
  ASSERT_EQ(back.patches.size(), 1u);
  EXPECT_EQ(back.patches[0].box, patch.box);
  EXPECT_EQ(back.patches[0].centroid, patch.centroid);
  EXPECT_EQ(back.patches[0].eigenvalues, patch.eigenvalues);
  EXPECT_TRUE(back.patches[0].axes.isApprox(patch.axes));
}

TEST(SegmentationMessage, refusesLabelsWithoutPatches) {
  Segmentation segmentation;
  segmentation.labels = cv::Mat(2, 2, CV_32SC1, cv::Scalar(4));
  segmentation.edges = cv::Mat::zeros(2, 2, CV_8UC1);
  const auto message = toMessage(segmentation, someHeader());
  EXPECT_THAT(refusal([&] { fromMessage(*message); }), HasSubstr("label 4"));
}

TEST(SceneFeaturesMessage, comesBackAsItWent) {
  const SceneFeatures features = threeFeatures();
  const auto message = toMessage(features, someHeader());
  const SceneFeatures back = fromMessage(*message);
  EXPECT_EQ(back.image.type, DescriptorType::kSurf64);
  EXPECT_EQ(cv::norm(back.image.descriptors, features.image.descriptors, cv::NORM_INF), 0.0);
  ASSERT_EQ(back.points.size(), 3u);
  EXPECT_EQ(back.points[2], features.points[2]);
  EXPECT_EQ(back.image.keypoints[1].x, 2.5f);
  EXPECT_TRUE(back.image.keypoints[1].bright);
  EXPECT_EQ(back.without_depth.count(), 0);
}

TEST(SceneFeaturesMessage, refusesArraysThatDoNotFit) {
  const auto message = toMessage(threeFeatures(), someHeader());
  message->image.descriptors.pop_back();
  EXPECT_THAT(refusal([&] { fromMessage(*message); }), HasSubstr("191 descriptor values"));
  message->image.descriptors.push_back(std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(refusal([&] { fromMessage(*message); }), HasSubstr("not finite"));
  message->image.descriptors.back() = 0.0f;
  message->points.pop_back();
  EXPECT_THAT(refusal([&] { fromMessage(*message); }), HasSubstr("2 points for 3 features"));
  message->image.descriptor = "orb";
  EXPECT_THAT(refusal([&] { fromMessage(*message); }), HasSubstr("orb"));
}

TEST(HypothesisMessage, comesBackAsItWentInAnotherOrderOfModels) {
  Hypothesis hypothesis;
  hypothesis.object = 1;
  hypothesis.camera_from_object = samplePose();
  hypothesis.consensus = {{0, 4, 0.25f}, {2, 0, 0.5f}};
  const auto message = toMessage({hypothesis}, 2, twoModels(), someHeader());
  ModelDatabase other = twoModels();
  std::swap(other.objects[0], other.objects[1]);
  const auto back = fromMessage(*message, other, threeFeatures());
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].object, 0);
  EXPECT_EQ(back[0].round, 2);
  ASSERT_EQ(back[0].consensus.size(), 2u);
  EXPECT_EQ(back[0].consensus[0].model_feature, 4);
  EXPECT_EQ(back[0].consensus[1].distance, 0.5f);
}

TEST(HypothesisMessage, refusesUnknownObjectsAndFeatures) {
  Hypothesis hypothesis;
  hypothesis.object = 0;
  hypothesis.consensus = {{0, 5, 0.25f}};
  const auto message = toMessage({hypothesis}, 0, twoModels(), someHeader());
  EXPECT_THAT(refusal([&] { fromMessage(*message, twoModels(), threeFeatures()); }), HasSubstr("correspondence 0-5"));
  message->hypotheses[0].object = "teapot";
  EXPECT_THAT(refusal([&] { fromMessage(*message, twoModels(), threeFeatures()); }), HasSubstr("'teapot'"));
}

TEST(DetectionMessage, numbersInstancesAndGivesReasons) {
  VerifiedHypothesis first, second, rejected;
  first.hypothesis.object = second.hypothesis.object = 0;
  first.covariance(0, 5) = 0.25;
  rejected.hypothesis.object = 1;
  rejected.rejection = Rejection::kConflict;
  rejected.conflict_with = "can";
  const auto message = toMessage({first, second, rejected}, twoModels(), someHeader());
  ASSERT_EQ(message->detections.size(), 3u);
  EXPECT_EQ(message->detections[0].instance, 0u);
  EXPECT_EQ(message->detections[1].instance, 1u);
  EXPECT_EQ(message->detections[2].instance, 0u);
  EXPECT_EQ(message->detections[0].pose.covariance[5], 0.25);
  EXPECT_TRUE(message->detections[0].accepted);
  EXPECT_EQ(message->detections[0].rejection, "");
  EXPECT_FALSE(message->detections[2].accepted);
  EXPECT_EQ(message->detections[2].rejection, rejectionName(Rejection::kConflict));
  EXPECT_EQ(message->detections[2].conflict_with, "can");
}

}  // namespace
}  // namespace recognition
