#include <diagnostic_msgs/DiagnosticStatus.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/image_encodings.h>
#include <sys/file.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "openni2/camera_bench.h"
#include "openni2/openni2_bench.h"
#include "openni2/test_recording.h"

namespace recognition::openni2 {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using ::testing::HasSubstr;

constexpr double kPeriod = 1.0 / 30.0;

/// The virtual bus and a recording, for the process: OpenNI2 reads the bus' place once.
struct Bench {
  TemporaryDirectory directory;
  std::string bus = directory.string();
  std::string recording = writeTestRecording(directory.string(), 4);
};

Bench* bench = nullptr;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Which frame of the test recording the image shows.
int recordedIndex(const sensor_msgs::Image& image) { return (image.data[0] - 40) / 50; }

uint16_t depthAt(const sensor_msgs::Image& image, int u, int v) {
  return reinterpret_cast<const uint16_t*>(image.data.data() + v * image.step)[u];
}

/// Each test has its own camera, named after it, at a port of the same name.
class OpenNi2Camera : public ::testing::Test {
 protected:
  void SetUp() override { name_ = ::testing::UnitTest::GetInstance()->current_test_info()->name(); }
  void TearDown() override {
    for (const std::string& port : plugged_) plugOut(bench->bus, port);
    openni::Array<openni::DeviceInfo> devices;
    do {  // OpenNI2 must not end while it learns that a device has gone
      ros::WallDuration(0.01).sleep();
      openni::OpenNI::enumerateDevices(&devices);
    } while (isPluggedIn(devices));
  }

  bool isPluggedIn(const openni::Array<openni::DeviceInfo>& devices) const {
    for (int i = 0; i < devices.getSize(); ++i) {
      for (const std::string& port : plugged_) {
        if (devices[i].getUri() == "virtual:" + port) return true;
      }
    }
    return false;
  }

  /// Plugs in a device with this serial number.
  void plug(const std::string& port, const std::string& serial, const std::string& access = "") {
    plugIn(bench->bus, port, bench->recording, serial, access);
    plugged_.push_back(port);
  }
  void unplug(const std::string& port) {
    plugOut(bench->bus, port);
    plugged_.erase(std::remove(plugged_.begin(), plugged_.end(), port), plugged_.end());
  }

  /// A camera at the port named after the test, which has that serial number.
  std::unique_ptr<Camera> start(std::map<std::string, XmlRpc::XmlRpcValue> parameters = {}) {
    plug(name_, name_);
    parameters.emplace("device_id", name_);
    return std::make_unique<Camera>(name_, parameters);
  }

  std::string name_;
  std::vector<std::string> plugged_;
};

TEST_F(OpenNi2Camera, DoesNotWarnThatAVirtualDeviceHasNoCalibration) {
  Listener<rosgraph_msgs::Log> log("/rosout");
  const auto camera = start();
  ImageListener color(camera->topic("rgb/image_raw"));
  InfoListener info(camera->topic("rgb/camera_info"));
  ASSERT_TRUE(color.next());
  ASSERT_TRUE(info.next()) << "from then on the calibration was asked for";
  ASSERT_TRUE(log.any([](const rosgraph_msgs::Log& line) { return contains(line.msg, "opened"); }));
  for (const auto& line : log.all())
    EXPECT_TRUE(line->level < rosgraph_msgs::Log::WARN || !contains(line->msg, "alibration")) << line->msg;
}

TEST_F(OpenNi2Camera, RefusesTimeOffsetsOutOfRange) {
  const auto camera = start();
  ASSERT_TRUE(camera->loaded());
  EXPECT_EQ(camera->reconfigure("color_time_offset", 0.5), 0.5);
  EXPECT_EQ(camera->reconfigure("color_time_offset", 70.0), 0.5);
}

TEST_F(OpenNi2Camera, PublishesColourAndRegisteredDepthUnderTheCommunitysNames) {
  const auto camera = start({{"camera_name", "cam"}});
  ASSERT_TRUE(camera->loaded());
  ImageListener color(camera->topic("rgb/image_raw")), depth(camera->topic("depth_registered/image_raw"));
  InfoListener color_info(camera->topic("rgb/camera_info")), depth_info(camera->topic("depth_registered/camera_info"));
  ASSERT_TRUE(color.next() && depth.next());
  const auto color_image = color.next();
  ASSERT_TRUE(color_image);
  EXPECT_EQ("rgb8", color_image->encoding);
  EXPECT_EQ(640u, color_image->width);
  EXPECT_EQ(640u * 3, color_image->step);
  EXPECT_EQ(480u * 640 * 3, color_image->data.size());
  EXPECT_EQ("cam_rgb_optical_frame", color_image->header.frame_id);
  const int index = recordedIndex(*color_image);
  const uint8_t* pixel = &color_image->data[(100 * 640 + 200) * 3];
  EXPECT_EQ(testColor(index, 200, 100), cv::Vec3b(pixel[0], pixel[1], pixel[2]));

  const auto depth_image = depth.next();
  ASSERT_TRUE(depth_image);
  EXPECT_EQ("16UC1", depth_image->encoding);
  EXPECT_EQ("cam_rgb_optical_frame", depth_image->header.frame_id);
  EXPECT_EQ(400, depthAt(*depth_image, 400, 100) - depthAt(*depth_image, 300, 100));

  for (InfoListener* listener : {&color_info, &depth_info}) {
    const auto info = listener->next();
    ASSERT_TRUE(info);
    EXPECT_EQ("cam_rgb_optical_frame", info->header.frame_id);
    EXPECT_EQ(640u, info->width);
    EXPECT_NEAR(525.0, info->K[0], 1e-3);
    EXPECT_NEAR(310.0, info->P[2], 1e-9);
    EXPECT_NEAR(245.0, info->K[5], 1e-9);
  }
}

TEST_F(OpenNi2Camera, ColourAndDepthOfOneMomentHaveOneStamp) {
  const auto camera = start();
  ImageListener color(camera->topic("rgb/image_raw")), depth(camera->topic("depth_registered/image_raw"));
  InfoListener info(camera->topic("rgb/camera_info"));
  ASSERT_TRUE(depth.next());
  const auto color_image = color.next();
  ASSERT_TRUE(color_image);
  EXPECT_TRUE(
      depth.next([&](const sensor_msgs::Image& image) { return image.header.stamp >= color_image->header.stamp; }));
  std::vector<ros::Time> stamps;
  for (const auto& image : depth.nextOf(10)) stamps.push_back(image->header.stamp);
  const auto last = color.next([&](const sensor_msgs::Image& image) { return image.header.stamp > stamps.back(); });
  ASSERT_TRUE(last);
  int pairs = 0;
  for (const auto& image : color.all()) pairs += std::count(stamps.begin(), stamps.end(), image->header.stamp);
  EXPECT_GE(pairs, 8);
}

TEST_F(OpenNi2Camera, StampsKeepTheDevicesSpacingWhateverTheArrival) {
  const auto camera = start({{"color_mode", "QVGA_30Hz"}});
  ImageListener color(camera->topic("rgb/image_raw"));
  ASSERT_TRUE(color.next());
  const auto images = color.nextOf(60);
  ASSERT_GE(images.size(), 60u);
  double worst = 0.0;
  for (size_t i = images.size() - 30; i < images.size(); ++i) {
    const double spacing = (images[i]->header.stamp - images[i - 1]->header.stamp).toSec();
    EXPECT_GT(spacing, 0.0);
    worst = std::max(worst, std::abs(spacing - kPeriod * std::lround(spacing / kPeriod)));
  }
  EXPECT_LT(worst, 0.002);
  EXPECT_NEAR(ros::Time::now().toSec(), images.back()->header.stamp.toSec(), 1.0);
}

TEST_F(OpenNi2Camera, SubscribersGetTheDriversBufferItself) {
  const auto camera = start();
  ImageListener first(camera->topic("rgb/image_raw")), second(camera->topic("rgb/image_raw"));
  ASSERT_TRUE(first.next() && second.next());
  const auto image = first.next();
  ASSERT_TRUE(image);
  bool same = false;
  for (int i = 0; i < 100 && !same; ++i) {
    ros::WallDuration(0.05).sleep();
    for (const auto& other : second.all()) same = same || other == image;
  }
  EXPECT_TRUE(same);
}

TEST_F(OpenNi2Camera, StreamsRunOnlyWhileSomebodyListens) {
  const auto camera = start();
  const auto running = [](const char* stream, bool on) {
    return [=](int, const std::string&, const Camera::Values& values) {
      const auto found = values.find(std::string(stream) + " running");
      return found != values.end() && found->second == (on ? "True" : "False");
    };
  };
  EXPECT_TRUE(camera->reports(running("rgb", false)));
  {
    InfoListener info(camera->topic("rgb/camera_info"));
    EXPECT_TRUE(info.next());
    EXPECT_TRUE(camera->reports(running("rgb", true)));
    EXPECT_TRUE(camera->reports(running("depth", false)));
  }
  EXPECT_TRUE(camera->reports(running("rgb", false)));
}

TEST_F(OpenNi2Camera, ChangesModesAndRegistrationWhileRunning) {
  const auto camera = start();
  ImageListener color(camera->topic("rgb/image_raw")), registered(camera->topic("depth_registered/image_raw"));
  ImageListener depth(camera->topic("depth/image_raw"));
  InfoListener color_info(camera->topic("rgb/camera_info")), depth_info(camera->topic("depth/camera_info"));
  ASSERT_TRUE(color.next() && registered.next());

  EXPECT_EQ("SXGA_15Hz", camera->reconfigure("color_mode", "SXGA_15Hz"));
  ASSERT_TRUE(color.next([](const sensor_msgs::Image& image) { return image.width == 1280 && image.height == 1024; }));
  const auto info = color_info.next([](const sensor_msgs::CameraInfo& info) { return info.width == 1280; });
  ASSERT_TRUE(info);
  EXPECT_NEAR(1050.0, info->K[0], 1e-3);
  EXPECT_NEAR(490.5, info->K[5], 1e-9);

  EXPECT_FALSE(camera->reconfigure("depth_registration", false));
  const auto unregistered = depth.next();
  ASSERT_TRUE(unregistered);
  EXPECT_EQ("camera_depth_optical_frame", unregistered->header.frame_id);
  ASSERT_TRUE(depth_info.next());

  EXPECT_EQ("SXGA_15Hz", camera->reconfigure("color_mode", "no such mode"));
  EXPECT_TRUE(color.next());
}

TEST_F(OpenNi2Camera, SaysWhatTheDeviceCannot) {
  const auto camera = start({{"depth_mode", "SXGA_30Hz"}});
  EXPECT_TRUE(camera->reports([](int level, const std::string& message, const Camera::Values& values) {
    return level == DiagnosticStatus::WARN && contains(message, "no SXGA_30Hz") &&
           values.at("depth mode") == "VGA_30Hz";
  }));
}

TEST_F(OpenNi2Camera, GoesOnWhenTheDeviceIsPluggedInElsewhere) {
  const auto camera = start();
  ImageListener depth(camera->topic("depth_registered/image_raw"));
  ASSERT_TRUE(depth.next());
  unplug(name_);
  EXPECT_TRUE(camera->reports(
      [](int level, const std::string&, const Camera::Values&) { return level == DiagnosticStatus::ERROR; }));
  plug(name_ + "2", name_);
  EXPECT_TRUE(depth.next());
  EXPECT_TRUE(camera->reports([this](int level, const std::string&, const Camera::Values& values) {
    return level == DiagnosticStatus::OK && values.at("uri") == "virtual:" + name_ + "2";
  }));
}

TEST_F(OpenNi2Camera, WaitsForADeviceThatIsNotThere) {
  Camera camera(name_, {{"device_id", name_}});
  ASSERT_TRUE(camera.loaded());
  ImageListener depth(camera.topic("depth_registered/image_raw"));
  EXPECT_TRUE(camera.reports([this](int level, const std::string& message, const Camera::Values&) {
    return level == DiagnosticStatus::ERROR && contains(message, "waiting for device with serial number " + name_);
  }));
  EXPECT_EQ(0u, depth.count());
  plug(name_, name_);
  EXPECT_TRUE(depth.next());
}

TEST_F(OpenNi2Camera, WaitsForABusyDevice) {
  plug(name_, name_);
  const int other = open((bench->bus + "/" + name_ + ".kinect").c_str(), O_RDONLY);
  ASSERT_EQ(0, flock(other, LOCK_EX | LOCK_NB));
  Camera camera(name_, {{"device_id", "virtual:" + name_}});
  EXPECT_TRUE(camera.reports([](int level, const std::string& message, const Camera::Values&) {
    return level == DiagnosticStatus::ERROR && contains(message, "busy");
  }));
  close(other);
  ImageListener depth(camera.topic("depth_registered/image_raw"));
  EXPECT_TRUE(depth.next());
}

TEST_F(OpenNi2Camera, NamesTheUdevRuleWhenPermissionIsDenied) {
  plug(name_, name_, "denied");
  Camera camera(name_, {{"device_id", "virtual:" + name_}});
  EXPECT_TRUE(camera.reports([](int level, const std::string& message, const Camera::Values&) {
    return level == DiagnosticStatus::ERROR && contains(message, "permission denied") &&
           contains(message, "60-rgbd-recognition.rules");
  }));
}

TEST_F(OpenNi2Camera, TwoCamerasAtOnce) {
  const auto first = start();
  plug(name_ + "2", name_ + "2");
  Camera second(name_ + "2", {{"device_id", name_ + "2"}, {"camera_name", "second"}});
  ImageListener first_depth(first->topic("depth_registered/image_raw")),
      second_depth(second.topic("depth_registered/image_raw"));
  EXPECT_TRUE(first_depth.next());
  const auto image = second_depth.next();
  ASSERT_TRUE(image);
  EXPECT_EQ("second_rgb_optical_frame", image->header.frame_id);

  Listener<tf2_msgs::TFMessage> frames("/tf_static");
  EXPECT_TRUE(frames.any([](const tf2_msgs::TFMessage& message) { return message.transforms.size() >= 8; }));
}

TEST_F(OpenNi2Camera, TwoCamerasDoNotShareADevice) {
  const auto first = start();
  ImageListener depth(first->topic("depth_registered/image_raw"));
  ASSERT_TRUE(depth.next());
  Camera second(name_ + "2", {{"device_id", "virtual:" + name_}});
  EXPECT_TRUE(second.reports([](int level, const std::string& message, const Camera::Values&) {
    return level == DiagnosticStatus::ERROR && contains(message, "busy");
  }));
}

TEST_F(OpenNi2Camera, InfraredGivesWayToColour) {
  const auto camera = start();
  ImageListener infrared(camera->topic("ir/image"));
  const auto image = infrared.next();
  ASSERT_TRUE(image);
  EXPECT_EQ("mono16", image->encoding);
  EXPECT_EQ("camera_depth_optical_frame", image->header.frame_id);
  {
    ImageListener color(camera->topic("rgb/image_raw"));
    EXPECT_TRUE(color.next());
    EXPECT_TRUE(camera->reports(
        [](int, const std::string&, const Camera::Values& values) { return values.at("ir running") == "False"; }));
  }
  EXPECT_TRUE(infrared.next());
}

TEST_F(OpenNi2Camera, ProjectorInfoComesWithDepth) {
  const auto camera = start({{"depth_mode", "QVGA_30Hz"}});
  InfoListener projector(camera->topic("projector/camera_info"));
  const auto info = projector.next();
  ASSERT_TRUE(info);
  EXPECT_NEAR(-0.075 * 262.5, info->P[3], 1e-3);
}

TEST_F(OpenNi2Camera, PlaysAnOniFile) {
  const std::string file = bench->directory.string() + "/" + name_ + ".oni";
  {
    openni::Device device;
    ASSERT_EQ(openni::STATUS_OK, device.open(("virtual:" + bench->recording).c_str()));
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
    openni::VideoStream color, depth;
    color.create(device, openni::SENSOR_COLOR);
    depth.create(device, openni::SENSOR_DEPTH);
    openni::Recorder recorder;
    ASSERT_EQ(openni::STATUS_OK, recorder.create(file.c_str()));
    recorder.attach(color);
    recorder.attach(depth);
    recorder.start();
    color.start();
    depth.start();
    for (int i = 0; i < 15; ++i) nextFrame(depth);
  }
  Camera camera(name_, {{"device_id", file}});
  ImageListener color(camera.topic("rgb/image_raw")), depth(camera.topic("depth_registered/image_raw"));
  EXPECT_EQ(40u, color.nextOf(40).size());  // the file holds 15: it starts anew
  EXPECT_TRUE(depth.next());
}

TEST_F(OpenNi2Camera, RefusesBadParameters) {
  plug(name_, name_);
  EXPECT_FALSE(Camera(name_, {{"color_mode", "huge"}}).loaded());
  EXPECT_FALSE(Camera(name_, {{"device_id", "#none"}}).loaded());
  EXPECT_FALSE(Camera(name_, {{"retry_period", -1.0}}).loaded());
  EXPECT_FALSE(Camera(name_, {{"retry_period", "often"}}).loaded());
}

}  // namespace
}  // namespace recognition::openni2

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "openni2_camera_test");
  using recognition::openni2::bench;
  recognition::openni2::Bench for_the_process;
  bench = &for_the_process;
  setenv("VIRTUAL_KINECT_BUS", bench->bus.c_str(), 1);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return recognition::openni2::runTestsWithOpenNi2();
}
