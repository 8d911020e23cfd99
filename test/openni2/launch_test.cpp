/// What openni2.launch brings up, whatever the device: the pictures are those of the demo's recording.

#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>

#include "openni2/listener.h"

namespace recognition::openni2 {
namespace {

TEST(OpenNi2Launch, ColourAndRegisteredDepthComeWithTheirCameraInfo) {
  ImageListener color("/camera/rgb/image_raw"), depth("/camera/depth_registered/image_raw");
  InfoListener color_info("/camera/rgb/camera_info"), depth_info("/camera/depth_registered/camera_info");
  const auto color_image = color.next();
  const auto depth_image = depth.next();
  ASSERT_TRUE(color_image && depth_image);
  EXPECT_EQ(640u, color_image->width);
  EXPECT_EQ("16UC1", depth_image->encoding);
  const auto* millimetres = reinterpret_cast<const uint16_t*>(depth_image->data.data());
  const auto seen = std::count_if(millimetres, millimetres + 640 * 480, [](uint16_t z) { return z > 300 && z < 5000; });
  EXPECT_GT(seen, 640 * 480 / 3);
  for (InfoListener* listener : {&color_info, &depth_info}) {
    const auto info = listener->next();
    ASSERT_TRUE(info);
    EXPECT_EQ("camera_rgb_optical_frame", info->header.frame_id);
    EXPECT_GT(info->K[0], 400.0);
    EXPECT_LT(info->K[0], 1200.0);
  }
}

TEST(OpenNi2Launch, FramesComeAtAboutThirtyHertz) {
  ImageListener color("/camera/rgb/image_raw");
  ASSERT_TRUE(color.next());
  const auto images = color.nextOf(30);
  ASSERT_GE(images.size(), 30u);
  const double seconds = (images.back()->header.stamp - images.front()->header.stamp).toSec();
  EXPECT_LT(seconds, 2.0 * (images.size() - 1) / 30.0);
}

TEST(OpenNi2Launch, TellsWhereTheCamerasAre) {
  Listener<tf2_msgs::TFMessage> frames("/tf_static");
  EXPECT_TRUE(frames.any([](const tf2_msgs::TFMessage& message) {
    return std::any_of(message.transforms.begin(), message.transforms.end(),
                       [](const auto& transform) { return transform.child_frame_id == "camera_rgb_optical_frame"; });
  }));
}

}  // namespace
}  // namespace recognition::openni2

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "openni2_launch_test");
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
