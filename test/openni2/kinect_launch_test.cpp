/// kinect.launch on a virtual Kinect that plays the demo's recording: from the device to the objects' poses.

#include <gtest/gtest.h>
#include <rgbd_recognition/DetectionArray.h>

#include <cmath>
#include <set>

#include "openni2/listener.h"

namespace recognition::openni2 {
namespace {

constexpr double kTolerance = 0.03;  // m; the ground truth is good to a centimetre

struct Truth {
  const char* object;
  double x, y, z;  // m, scene_gt.json of the recording's first frame; the second differs by 6 mm
};

constexpr Truth kTruth[] = {{"003_cracker_box", -0.098, 0.093, 1.144}, {"004_sugar_box", 0.126, 0.222, 0.990}};

bool isAt(const rgbd_recognition::Detection& detection, const Truth& truth) {
  const auto& p = detection.pose.pose.position;
  return detection.object == truth.object &&
         std::hypot(std::hypot(p.x - truth.x, p.y - truth.y), p.z - truth.z) < kTolerance;
}

TEST(KinectLaunch, FindsTheDemosObjectsWhereTheyAre) {
  Listener<rgbd_recognition::DetectionArray> detections("/recognition/detections");
  std::set<std::string> found;
  // With tracking each frame is answered, and the first ones before the first search has ended.
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(30.0);
  while (ros::WallTime::now() < end && found.size() < std::size(kTruth)) {
    const auto array = detections.next();
    ASSERT_TRUE(array) << "no answer";
    EXPECT_EQ("camera_rgb_optical_frame", array->header.frame_id);
    for (const rgbd_recognition::Detection& detection : array->detections) {
      for (const Truth& truth : kTruth) {
        if (detection.accepted && isAt(detection, truth)) found.insert(truth.object);
      }
    }
  }
  EXPECT_EQ(std::size(kTruth), found.size());
}

}  // namespace
}  // namespace recognition::openni2

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "kinect_launch_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
