/// The driver of the Microsoft Kinect, over fakenect, which replays a dump written from the test recording.

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "openni2/kinect_dump.h"
#include "openni2/openni2_bench.h"
#include "openni2/test_recording.h"

namespace recognition::openni2 {
namespace {

constexpr char kUri[] = "freenect:0";

TEST(Freenect, IsListed) {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  ASSERT_EQ(1, devices.getSize());
  EXPECT_STREQ(kUri, devices[0].getUri());
  EXPECT_STREQ("Microsoft", devices[0].getVendor());
}

TEST(Freenect, StreamsColourAndRegisteredDepth) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(kUri)) << openni::OpenNI::getExtendedError();
  ASSERT_EQ(openni::STATUS_OK, device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR));
  openni::VideoStream color, depth;
  ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  openni::VideoFrameRef color_frame, depth_frame;
  nextPair(color, depth, &color_frame, &depth_frame);
  const int index = recordedIndex(color_frame);
  const auto* pixel = static_cast<const openni::RGB888Pixel*>(color_frame.getData()) + 200 * 640 + 300;
  EXPECT_EQ(testColor(index, 300, 200), cv::Vec3b(pixel->r, pixel->g, pixel->b));
  // The edge between near and far is where colour has it; 11 bits resolve a few millimetres here.
  EXPECT_NEAR(testDepth(index, 310), depthAt(depth_frame, 310, 200), 8);
  EXPECT_NEAR(testDepth(index, 500), depthAt(depth_frame, 500, 200), 8);
}

TEST(Freenect, UnregisteredDepthIsTheInfraredCamerasOwn) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(kUri));
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  const openni::VideoFrameRef frame = nextFrame(depth);
  EXPECT_EQ(openni::PIXEL_FORMAT_DEPTH_1_MM, frame.getVideoMode().getPixelFormat());
  const int shift = 580 * 25 / 1100;
  EXPECT_LT(depthAt(frame, 320 + shift / 2, 200), 1100);  // near reaches farther right than in colour
}

TEST(Freenect, StampsAreMicrosecondsOfTheKinectsClock) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(kUri));
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  const openni::VideoFrameRef first = nextFrame(depth);
  const openni::VideoFrameRef second = nextFrame(depth);
  const int frames = second.getFrameIndex() - first.getFrameIndex();  // negative where the dump starts anew
  EXPECT_NEAR(frames * 1e6 / 30, static_cast<double>(second.getTimestamp()) - static_cast<double>(first.getTimestamp()),
              2.0);
}

TEST(Freenect, StopsAndStartsAgain) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(kUri));
  openni::VideoStream color;
  ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(openni::STATUS_OK, color.start());
    EXPECT_TRUE(nextFrame(color).isValid());
    color.stop();
  }
}

TEST(Freenect, OffersOnlyWhatTheLibraryHas) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(kUri));
  EXPECT_FALSE(device.hasSensor(openni::SENSOR_IR));  // fakenect has none
  EXPECT_EQ(1, device.getSensorInfo(openni::SENSOR_COLOR)->getSupportedVideoModes().getSize());
}

}  // namespace
}  // namespace recognition::openni2

int main(int argc, char** argv) {
  using namespace recognition::openni2;
  ::testing::InitGoogleTest(&argc, argv);
  const recognition::TemporaryDirectory directory;
  const std::string dump = directory.string() + "/dump";
  writeKinectDump(writeTestRecording(directory.string(), 4), dump, 60.0);
  setenv("FAKENECT_PATH", dump.c_str(), 1);
  return runTestsWithOpenNi2();
}
