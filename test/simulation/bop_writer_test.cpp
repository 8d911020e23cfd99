#include "simulation/bop_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "simulation/fixtures.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

AnnotatedFrame sampleFrame(int id) {
  AnnotatedFrame annotated;
  annotated.frame.color = cv::Mat(8, 8, CV_8UC3, cv::Scalar(1, 2, id));
  annotated.frame.depth = cv::Mat(8, 8, CV_16UC1, cv::Scalar(1234));
  annotated.frame.color_camera = {8, 8, 10.5, 10.5, 3.5, 3.5};
  AnnotatedObject object;
  object.object_id = id;
  object.camera_from_object =
      Eigen::Translation3d(0.1, 0.2, 0.9) * Pose(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
  object.visibility.all = 10;
  object.visibility.visible = 4;
  annotated.objects = {object};
  return annotated;
}

TEST(BopWriter, IsReadBackAsWritten) {
  const TemporaryDirectory folder;
  const BopWriter writer(folder.string(), "test_kinect", 2);
  for (int i = 0; i < 3; ++i) writer.write(i, sampleFrame(i + 1));
  writer.finish(3);
  const auto frames = readBopSplit(folder / "test_kinect");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2].name(), "000002/000000");
  EXPECT_EQ(frames[2].ground_truth.at(0).object_id, 3);
  EXPECT_DOUBLE_EQ(frames[2].ground_truth[0].visibility, 0.4);
  const AnnotatedFrame expected = sampleFrame(3);
  EXPECT_TRUE(frames[2].ground_truth[0].camera_from_object.isApprox(expected.objects[0].camera_from_object, 1e-12));
  const RgbdFrame frame = loadBopFrame(frames[2]);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
  EXPECT_FLOAT_EQ(frame.depth.at<float>(0, 0), 1.234f);
  EXPECT_DOUBLE_EQ(frame.color_camera.fx, 10.5);
}

TEST(BopWriter, WritesTheChallengesTable) {
  const TemporaryDirectory folder;
  const BopWriter writer(folder.string(), "test_kinect", 2);
  writer.write(0, sampleFrame(7));
  writer.finish(1);
  EXPECT_THAT(readText(folder / "test_kinect_ground_truth.csv"),
              testing::StartsWith("Ts,Run,Frame,dID,oID,R11,R12,R13,R21,R22,R23,R31,R32,R33,Tx,Ty,Tz\n0,1,0,7,0,"));
}

TEST(BopWriter, WhatIsThereCanBeReadAtAnyTime) {
  const TemporaryDirectory folder;
  const BopWriter writer(folder.string(), "test_kinect", 2);
  writer.write(2, sampleFrame(3));
  writer.write(1, sampleFrame(2));
  const auto frames = readBopSplit(folder / "test_kinect");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].name(), "000001/000001");
  EXPECT_EQ(frames[1].ground_truth.at(0).object_id, 3);
  writer.finish(4, true);
  EXPECT_THAT(readText(folder / "test_kinect_ground_truth.csv"), testing::HasSubstr("\n1,1,1,2,0,"));
}

TEST(BopWriter, KnowsWhatIsMissing) {
  const TemporaryDirectory folder;
  const BopWriter writer(folder.string(), "test_kinect", 2);
  writer.write(1, sampleFrame(1));
  EXPECT_FALSE(writer.has(0));
  EXPECT_TRUE(writer.has(1));
  EXPECT_THROW(writer.finish(2), std::runtime_error);
}

}  // namespace
}  // namespace recognition
