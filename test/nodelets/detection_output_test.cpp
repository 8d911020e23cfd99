#include <gtest/gtest.h>

#include "ros/detection_output.h"
#include "ros/message_conversions.h"

namespace recognition {
namespace {

using visualization_msgs::Marker;

/// A box of 0.06 x 0.12 x 0.24 m around (0.1, 0, 0).
ModelDatabase boxDatabase() {
  auto model = std::make_shared<ObjectModel>();
  model->name = "box";
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f cell(i % 10 / 9.0f - 0.5f, i / 10 % 10 / 9.0f - 0.5f, i / 100 / 9.0f - 0.5f);
    model->cloud.push_back({cell.cwiseProduct(Eigen::Vector3f(0.06f, 0.12f, 0.24f)) + Eigen::Vector3f(0.1f, 0.0f, 0.0f),
                            Eigen::Vector3f::UnitX(),
                            {255, 0, 0}});
  }
  model->extents = computeExtents(model->cloud);
  ModelDatabase database;
  database.objects.push_back(model);
  return database;
}

messages::DetectionArray oneDetection() {
  messages::DetectionArray detections;
  detections.header.frame_id = "optical";
  detections.header.stamp = ros::Time(5, 0);
  messages::Detection detection;
  detection.object = "box";
  detection.instance = 2;
  detection.confidence = 0.875;
  detection.pose.pose.position.z = 0.9;
  detection.pose.pose.orientation.w = 1.0;
  detection.accepted = true;
  detections.detections.push_back(detection);
  return detections;
}

TEST(Transforms, leadFromTheCameraToEachInstance) {
  messages::DetectionArray detections = oneDetection();
  nameFrames("", &detections);
  const auto transforms = transformsOf(detections);
  ASSERT_EQ(transforms->transforms.size(), 1u);
  EXPECT_EQ(transforms->transforms[0].child_frame_id, "box_2");
  EXPECT_EQ(transforms->transforms[0].header.frame_id, "optical");
  EXPECT_EQ(transforms->transforms[0].header.stamp, ros::Time(5, 0));
  EXPECT_EQ(transforms->transforms[0].transform.translation.z, 0.9);
}

TEST(Transforms, haveThePrefixAndAreOfTheAccepted) {
  messages::DetectionArray detections = oneDetection();
  detections.detections.push_back(detections.detections.front());
  detections.detections.back().accepted = false;
  EXPECT_TRUE(transformsOf(detections)->transforms.empty()) << "tf is off: no frame is named";
  nameFrames("left/", &detections);
  EXPECT_EQ(detections.detections.back().frame, "");
  const auto transforms = transformsOf(detections);
  ASSERT_EQ(transforms->transforms.size(), 1u);
  EXPECT_EQ(transforms->transforms[0].child_frame_id, "left/box_2");
}

TEST(ChangeFrame, turnsPoseAndCovariance) {
  messages::DetectionArray detections = oneDetection();
  detections.detections[0].pose.covariance[0] = 1.0;          // x
  detections.detections[0].pose.covariance[6 * 4 + 4] = 2.0;  // about y
  Pose base_from_optical = Pose::Identity();                  // z forward -> x, x right -> -y, y down -> -z
  base_from_optical.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  base_from_optical.translation() << 0.1, 0.0, 1.0;
  changeFrame(base_from_optical, "base", &detections);
  EXPECT_EQ(detections.header.frame_id, "base");
  EXPECT_EQ(detections.header.stamp, ros::Time(5, 0));
  const auto& pose = detections.detections[0].pose;
  EXPECT_NEAR(pose.pose.position.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.pose.position.z, 1.0, 1e-12);
  EXPECT_NEAR(pose.covariance[6 * 1 + 1], 1.0, 1e-12);
  EXPECT_NEAR(pose.covariance[6 * 5 + 5], 2.0, 1e-12);
  EXPECT_NEAR(pose.covariance[0], 0.0, 1e-12);
}

TEST(MarkerMaker, drawsCloudEllipsoidAndLabel) {
  const ModelDatabase database = boxDatabase();
  const auto markers = MarkerMaker().make(oneDetection(), database, LabelView::ofCamera())->markers;
  ASSERT_EQ(markers.size(), 4u);
  EXPECT_EQ(markers[0].action, Marker::DELETEALL);
  EXPECT_EQ(markers[1].type, Marker::POINTS);
  EXPECT_EQ(markers[1].points.size(), 1000u);
  EXPECT_EQ(markers[1].colors[0].r, 1.0f);
  EXPECT_EQ(markers[2].type, Marker::SPHERE);
  EXPECT_NEAR(markers[2].pose.position.x, 0.1, 1e-6);
  EXPECT_NEAR(markers[2].scale.z, database.objects[0]->extents.sigma_max, 1e-3);
  EXPECT_NEAR(markers[2].scale.x, database.objects[0]->extents.sigma_min, 1e-3);
  EXPECT_EQ(markers[3].text, "box 0.88");
  for (const Marker& marker : markers) EXPECT_EQ(marker.header.frame_id, "optical");
}

TEST(MarkerMaker, saysWhyHypothesesWereRejected) {
  messages::DetectionArray hypotheses = oneDetection();
  hypotheses.detections[0].accepted = 1;
  hypotheses.detections.push_back(hypotheses.detections[0]);
  hypotheses.detections[1].accepted = 0;
  hypotheses.detections[1].rejection = "free_space";
  const auto markers = MarkerMaker().makeRejected(hypotheses, boxDatabase(), LabelView())->markers;
  ASSERT_EQ(markers.size(), 3u);  // removal of the last frame's, ellipsoid, label
  EXPECT_EQ(markers[2].text, "box 0.88: free space");
  for (const Marker& marker : markers) EXPECT_EQ(marker.header.frame_id, "optical");
  hypotheses.detections.resize(100, hypotheses.detections[1]);
  EXPECT_EQ(MarkerMaker().makeRejected(hypotheses, boxDatabase(), LabelView())->markers.size(), 3u)
      << "of each object one";
}

TEST(MarkerMaker, leavesOutWhatOthersExplain) {
  messages::DetectionArray hypotheses = oneDetection();
  for (const char* reason : {"duplicate", "explained"}) {
    hypotheses.detections[0].rejection = reason;
    EXPECT_EQ(MarkerMaker().makeRejected(hypotheses, boxDatabase(), LabelView())->markers.size(), 1u) << reason;
  }
}

TEST(MarkerMaker, labelsDoNotCoverEachOther) {
  messages::DetectionArray detections = oneDetection();
  detections.detections.resize(4, detections.detections[0]);
  detections.detections[1].pose.pose.position.x = 0.05;  // beside
  detections.detections[2].pose.pose.position.z = 1.1;   // behind
  detections.detections[3].pose.pose.position.x = 2.0;   // far away
  const auto markers = MarkerMaker().make(detections, boxDatabase(), LabelView::ofCamera())->markers;
  std::vector<geometry_msgs::Point> labels;
  for (const Marker& marker : markers)
    if (marker.type == Marker::TEXT_VIEW_FACING) labels.push_back(marker.pose.position);
  ASSERT_EQ(labels.size(), 4u);
  EXPECT_LT(labels[0].z, 0.9 - 0.06) << "before the object, as the camera sees it";
  EXPECT_NEAR(labels[3].x / labels[3].z, 2.1 / 0.9, 1e-6) << "over its middle in the picture";
  EXPECT_LT(labels[3].y, -0.06) << "above it; camera frame: y points down";
  for (size_t i = 0; i < labels.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const bool beside = std::abs(labels[i].x / labels[i].z - labels[j].x / labels[j].z) > 8 * 0.6 * 0.024 / 1.1;
      const bool above = std::abs(labels[i].y / labels[i].z - labels[j].y / labels[j].z) > 1.5 * 0.024 / 1.1;
      EXPECT_TRUE(beside || above) << i << " and " << j;
    }
}

/// Half the width and height of a label of eight letters, at least.
constexpr double kHalfWidth = 0.5 * 8 * 0.6 * 0.024, kHalfHeight = 0.5 * 0.024;

std::vector<geometry_msgs::Point> labelsOf(const messages::DetectionArray& detections, const LabelView& view) {
  std::vector<geometry_msgs::Point> labels;
  for (const Marker& marker : MarkerMaker().make(detections, boxDatabase(), view)->markers)
    if (marker.type == Marker::TEXT_VIEW_FACING) labels.push_back(marker.pose.position);
  return labels;
}

TEST(MarkerMaker, aLabelDoesNotCoverAnotherObject) {
  messages::DetectionArray detections = oneDetection();
  detections.detections.resize(2, detections.detections[0]);
  detections.detections[1].pose.pose.position.y = -0.15;  // right above the first one, in the picture
  const auto labels = labelsOf(detections, LabelView::ofCamera());
  ASSERT_EQ(labels.size(), 2u);
  // The other box: 0.06 x 0.12 m around (0.1, -0.15) at 0.9 m.
  const double x = labels[0].x / labels[0].z - 0.1 / 0.9, y = labels[0].y / labels[0].z + 0.15 / 0.9;
  EXPECT_TRUE(std::abs(x) > 0.03 / 0.9 + kHalfWidth / labels[0].z ||
              std::abs(y) > 0.06 / 0.9 + kHalfHeight / labels[0].z)
      << labels[0];
}

TEST(MarkerMaker, aLabelDoesNotLeaveThePicture) {
  const CameraModel camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  messages::DetectionArray detections = oneDetection();
  detections.detections[0].pose.pose.position.y = -0.35;  // at the upper rim
  const auto labels = labelsOf(detections, LabelView::ofCamera(camera));
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_GT(camera.project({labels[0].x, labels[0].y - kHalfHeight, labels[0].z}).y(), 0.0);
}

TEST(MarkerMaker, leavesOutUnknownObjects) {
  auto detections = oneDetection();
  detections.detections[0].object = "teapot";
  EXPECT_EQ(MarkerMaker().make(detections, boxDatabase(), LabelView())->markers.size(), 1u);
}

}  // namespace
}  // namespace recognition
