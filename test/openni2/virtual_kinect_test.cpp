#include <OpenNI.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "openni2/openni2_bench.h"
#include "openni2/test_recording.h"

namespace recognition::openni2 {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 3;

/// The virtual bus and a recording, for the process: OpenNI2 reads the bus' place once.
struct Bench {
  TemporaryDirectory directory;
  std::string bus = directory.string();
  std::string recording = writeTestRecording(directory.string(), kFrames);
};

Bench* bench = nullptr;

/// Which devices OpenNI2 says are there.
class Presence : public openni::OpenNI::DeviceConnectedListener, public openni::OpenNI::DeviceDisconnectedListener {
 public:
  Presence() {
    openni::OpenNI::addDeviceConnectedListener(this);
    openni::OpenNI::addDeviceDisconnectedListener(this);
  }
  ~Presence() {
    openni::OpenNI::removeDeviceConnectedListener(this);
    openni::OpenNI::removeDeviceDisconnectedListener(this);
  }
  void onDeviceConnected(const openni::DeviceInfo* info) override { note("+" + std::string(info->getUri())); }
  void onDeviceDisconnected(const openni::DeviceInfo* info) override { note("-" + std::string(info->getUri())); }

  bool waitFor(const std::string& event) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(kTimeout),
                             [&] { return std::find(events_.begin(), events_.end(), event) != events_.end(); });
  }

 private:
  void note(const std::string& event) {
    const std::lock_guard<std::mutex> lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> events_;
};

class VirtualKinect : public ::testing::Test {
 protected:
  void plugInAndWait(const std::string& port, const std::string& serial = "", const std::string& access = "") {
    plugIn(bench->bus, port, bench->recording, serial, access);
    ASSERT_TRUE(presence_.waitFor("+virtual:" + port));
  }
  void TearDown() override {
    for (const char* port : {"a", "b"}) {
      if (access((bench->bus + "/" + port + ".kinect").c_str(), F_OK) != 0) continue;
      plugOut(bench->bus, port);
      ASSERT_TRUE(presence_.waitFor(std::string("-virtual:") + port));
    }
  }

  Presence presence_;
};

TEST_F(VirtualKinect, StreamsTheRecordedColourAndRegisteredDepthWithCommonStamps) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a")) << openni::OpenNI::getExtendedError();
  ASSERT_EQ(openni::STATUS_OK, device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR));
  openni::VideoStream color, depth;
  ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  for (int i = 0; i < 5; ++i) {
    openni::VideoFrameRef color_frame, depth_frame;
    nextPair(color, depth, &color_frame, &depth_frame);
    ASSERT_EQ(640, color_frame.getWidth());
    ASSERT_EQ(color_frame.getTimestamp(), depth_frame.getTimestamp());
    const int index = recordedIndex(color_frame);
    const auto* pixel = static_cast<const openni::RGB888Pixel*>(color_frame.getData()) + 200 * 640 + 300;
    EXPECT_EQ(testColor(index, 300, 200), cv::Vec3b(pixel->r, pixel->g, pixel->b));
    EXPECT_EQ(testDepth(index, 300), depthAt(depth_frame, 300, 200));
    EXPECT_EQ(testDepth(index, 600), depthAt(depth_frame, 600, 200));
  }
}

TEST_F(VirtualKinect, KeepsThirtyFramesASecondOfItsOwnClock) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  openni::VideoFrameRef last = nextFrame(depth);
  for (int i = 0; i < 20; ++i) {
    const openni::VideoFrameRef frame = nextFrame(depth);
    const int ticks = frame.getFrameIndex() - last.getFrameIndex();
    ASSERT_GE(ticks, 1);
    EXPECT_NEAR(ticks * 1e6 / 30, static_cast<double>(frame.getTimestamp() - last.getTimestamp()), 1.0);
    last = frame;
  }
}

TEST_F(VirtualKinect, UnregisteredDepthIsSeenFromTheInfraredCamera) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  const openni::VideoFrameRef frame = nextFrame(depth);
  const int near_mm = depthAt(frame, 100, 100);
  const int shift =
      static_cast<int>(std::lround(kTestFocalLength * 25.0 / near_mm));  // 25 mm to the right of where colour has it
  EXPECT_EQ(near_mm, depthAt(frame, 319 + shift, 100));
  EXPECT_NE(near_mm, depthAt(frame, 320 + shift, 100));
  EXPECT_EQ(0, depthAt(frame, shift - 1, 100));
}

TEST_F(VirtualKinect, HasTheKinectsModes) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  openni::VideoStream color;
  ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
  ASSERT_EQ(openni::STATUS_OK, color.setVideoMode(mode(openni::PIXEL_FORMAT_RGB888, 1280, 1024, 30)));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  const openni::VideoFrameRef sxga = nextFrame(color);
  EXPECT_EQ(1280, sxga.getWidth());
  EXPECT_EQ(1024, sxga.getHeight());
  EXPECT_EQ(1280 * 3, sxga.getStrideInBytes());
  color.stop();
  ASSERT_EQ(openni::STATUS_OK, color.setVideoMode(mode(openni::PIXEL_FORMAT_RGB888, 320, 240, 15)));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  EXPECT_EQ(320, nextFrame(color).getWidth());
  EXPECT_EQ(0, nextFrame(color).getFrameIndex() % 2);
  EXPECT_NE(openni::STATUS_OK, color.setVideoMode(mode(openni::PIXEL_FORMAT_RGB888, 123, 240, 30)));
}

TEST_F(VirtualKinect, MirrorsOnDemand) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  EXPECT_FALSE(depth.getMirroringEnabled());
  ASSERT_EQ(openni::STATUS_OK, depth.setMirroringEnabled(true));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  const openni::VideoFrameRef frame = nextFrame(depth);
  EXPECT_EQ(depthAt(frame, 600, 10) + 400, depthAt(frame, 10, 10));
}

TEST_F(VirtualKinect, ColourAndInfraredExcludeEachOther) {
  plugInAndWait("a");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  openni::VideoStream color, infrared;
  ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
  ASSERT_EQ(openni::STATUS_OK, infrared.create(device, openni::SENSOR_IR));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  EXPECT_NE(openni::STATUS_OK, infrared.start());
  color.stop();
  ASSERT_EQ(openni::STATUS_OK, infrared.start());
  EXPECT_EQ(openni::PIXEL_FORMAT_GRAY16, nextFrame(infrared).getVideoMode().getPixelFormat());
}

TEST_F(VirtualKinect, ComesAndGoesWhileOpen) {
  plugInAndWait("a", "K1");
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  openni::VideoStream depth;
  ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  nextFrame(depth);
  plugOut(bench->bus, "a");
  ASSERT_TRUE(presence_.waitFor("-virtual:a"));
  depth.destroy();
  device.close();
  EXPECT_NE(openni::STATUS_OK, device.open("virtual:a"));

  plugInAndWait("b", "K1");
  ASSERT_EQ(openni::STATUS_OK, device.open("virtual:b"));
  char serial[64];
  int size = sizeof(serial);
  ASSERT_EQ(openni::STATUS_OK, device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size));
  EXPECT_STREQ("K1", serial);
}

TEST_F(VirtualKinect, TwoDevicesStreamSideBySide) {
  plugInAndWait("a");
  plugInAndWait("b");
  openni::Device first, second;
  ASSERT_EQ(openni::STATUS_OK, first.open("virtual:a"));
  ASSERT_EQ(openni::STATUS_OK, second.open("virtual:b"));
  openni::VideoStream first_depth, second_depth;
  ASSERT_EQ(openni::STATUS_OK, first_depth.create(first, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, second_depth.create(second, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, first_depth.start());
  ASSERT_EQ(openni::STATUS_OK, second_depth.start());
  EXPECT_TRUE(nextFrame(first_depth).isValid());
  EXPECT_TRUE(nextFrame(second_depth).isValid());
}

TEST_F(VirtualKinect, RefusesWhenBusyOrDeniedAndSaysSo) {
  plugInAndWait("a");
  const int other = open((bench->bus + "/a.kinect").c_str(), O_RDONLY);
  ASSERT_EQ(0, flock(other, LOCK_EX | LOCK_NB));
  openni::Device device;
  EXPECT_NE(openni::STATUS_OK, device.open("virtual:a"));
  EXPECT_THAT(openni::OpenNI::getExtendedError(), HasSubstr("busy"));
  close(other);
  EXPECT_EQ(openni::STATUS_OK, device.open("virtual:a"));
  device.close();

  plugInAndWait("b", "", "denied");
  EXPECT_NE(openni::STATUS_OK, device.open("virtual:b"));
  EXPECT_THAT(openni::OpenNI::getExtendedError(), HasSubstr("permission denied"));
}

TEST_F(VirtualKinect, AUriNamesARecordingDirectly) {
  openni::Device device;
  ASSERT_EQ(openni::STATUS_OK, device.open(("virtual:" + bench->recording).c_str()))
      << openni::OpenNI::getExtendedError();
  device.close();
  EXPECT_NE(openni::STATUS_OK, device.open("virtual:/nowhere/at/all"));
  EXPECT_THAT(openni::OpenNI::getExtendedError(), HasSubstr("/nowhere/at/all"));
}

TEST_F(VirtualKinect, IsRecordedToAnOniFileThatPlays) {
  const std::string file = bench->directory.string() + "/recorded.oni";
  {
    openni::Device device;
    ASSERT_EQ(openni::STATUS_OK, device.open(("virtual:" + bench->recording).c_str()));
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
    openni::VideoStream color, depth;
    ASSERT_EQ(openni::STATUS_OK, color.create(device, openni::SENSOR_COLOR));
    ASSERT_EQ(openni::STATUS_OK, depth.create(device, openni::SENSOR_DEPTH));
    openni::Recorder recorder;
    ASSERT_EQ(openni::STATUS_OK, recorder.create(file.c_str()));
    ASSERT_EQ(openni::STATUS_OK, recorder.attach(color));
    ASSERT_EQ(openni::STATUS_OK, recorder.attach(depth));
    ASSERT_EQ(openni::STATUS_OK, recorder.start());
    ASSERT_EQ(openni::STATUS_OK, color.start());
    ASSERT_EQ(openni::STATUS_OK, depth.start());
    for (int i = 0; i < 10; ++i) nextFrame(depth);
    recorder.stop();
    recorder.destroy();
  }
  openni::Device player;
  ASSERT_EQ(openni::STATUS_OK, player.open(file.c_str())) << openni::OpenNI::getExtendedError();
  openni::VideoStream color, depth;
  ASSERT_EQ(openni::STATUS_OK, color.create(player, openni::SENSOR_COLOR));
  ASSERT_EQ(openni::STATUS_OK, depth.create(player, openni::SENSOR_DEPTH));
  ASSERT_EQ(openni::STATUS_OK, color.start());
  ASSERT_EQ(openni::STATUS_OK, depth.start());
  const int index = recordedIndex(nextFrame(color));
  EXPECT_GE(index, 0);
  EXPECT_LT(index, kFrames);
  const openni::VideoFrameRef depth_frame = nextFrame(depth);
  EXPECT_EQ(400, depthAt(depth_frame, 600, 100) - depthAt(depth_frame, 100, 100));
}

}  // namespace
}  // namespace recognition::openni2

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  using recognition::openni2::bench;
  recognition::openni2::Bench for_the_process;
  bench = &for_the_process;
  setenv("VIRTUAL_KINECT_BUS", bench->bus.c_str(), 1);
  return recognition::openni2::runTestsWithOpenNi2();
}
