/// Measures the camera nodelet on a virtual Kinect, colour and registered depth at 640x480 and 30 Hz, in this process:
/// what it costs beyond OpenNI2 and the driver, what it loses, how late frames are. Needs a ROS master;
/// scripts/measure_camera brings one.

#include <OpenNI.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <vector>

namespace {

constexpr double kPeriod = 1.0 / 30.0;
constexpr double kSettling = 5.0;  // s before anything counts

double cpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double residentMegabytes() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// Share of a core that this process takes in the coming seconds.
double cpuShare(double seconds) {
  const double before = cpuSeconds();
  ros::WallDuration(seconds).sleep();
  return (cpuSeconds() - before) / seconds;
}

class Reader : public openni::VideoStream::NewFrameListener {
 public:
  void onNewFrame(openni::VideoStream& stream) override {
    openni::VideoFrameRef frame;
    stream.readFrame(&frame);
  }
};

double cpuShareOfOpenNi2(const std::string& uri, double seconds) {
  openni::Device device;
  if (device.open(uri.c_str()) != openni::STATUS_OK) {
    std::fprintf(stderr, "%s: %s\n", uri.c_str(), openni::OpenNI::getExtendedError());
    std::exit(1);
  }
  device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  openni::VideoStream color, depth;
  color.create(device, openni::SENSOR_COLOR);
  depth.create(device, openni::SENSOR_DEPTH);
  Reader reader;
  color.addNewFrameListener(&reader);
  depth.addNewFrameListener(&reader);
  color.start();
  depth.start();
  ros::WallDuration(kSettling).sleep();
  const double share = cpuShare(seconds);
  color.removeNewFrameListener(&reader);
  depth.removeNewFrameListener(&reader);
  return share;
}

/// What a topic's images tell.
class Watch {
 public:
  explicit Watch(const std::string& topic)
      : subscriber_(ros::NodeHandle().subscribe(topic, 10, &Watch::receive, this)) {}

  void restart() {
    const std::lock_guard<std::mutex> lock(mutex_);
    stamps_.clear();
    delays_.clear();
  }

  void print(const char* name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    long dropped = 0;
    double jitter = 0.0;
    for (size_t i = 1; i < stamps_.size(); ++i) {
      const double spacing = stamps_[i] - stamps_[i - 1];
      const long periods = std::max(1L, std::lround(spacing / kPeriod));
      dropped += periods - 1;
      jitter = std::max(jitter, std::abs(spacing - periods * kPeriod));
    }
    std::sort(delays_.begin(), delays_.end());
    if (delays_.empty()) return static_cast<void>(std::printf("%s: no frames\n", name));
    std::printf(
        "%-6s %zu frames, %ld dropped, stamps' jitter %.2f ms at most, delay median %.2f p95 %.2f max %.2f ms\n", name,
        stamps_.size(), dropped, 1e3 * jitter, 1e3 * delays_[delays_.size() / 2],
        1e3 * delays_[delays_.size() * 95 / 100], 1e3 * delays_.back());
  }

 private:
  void receive(const sensor_msgs::ImageConstPtr& image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stamps_.push_back(image->header.stamp.toSec());
    delays_.push_back((ros::Time::now() - image->header.stamp).toSec());
  }

  std::mutex mutex_;
  std::vector<double> stamps_;
  std::vector<double> delays_;
  ros::Subscriber subscriber_;
};

void measureNodelet(const std::string& uri, double seconds, double share_of_openni2) {
  for (const char* offset : {"color_time_offset", "depth_time_offset"})
    ros::param::set(std::string("/camera/driver/") + offset, 0.0);
  ros::param::set("/camera/driver/device_id", uri);
  nodelet::Loader loader(false);
  loader.load("/camera/driver", "rgbd_recognition/openni2_camera", ros::M_string(), nodelet::V_string());
  Watch color("/camera/rgb/image_raw"), depth("/camera/depth_registered/image_raw");
  ros::WallDuration(kSettling).sleep();
  color.restart();
  depth.restart();
  const double memory = residentMegabytes();
  const double share = cpuShare(seconds);
  color.print("rgb");
  depth.print("depth");
  std::printf("CPU: %.1f %% of a core with OpenNI2 and driver alone, %.1f %% with the nodelet and its subscribers\n",
              100.0 * share_of_openni2, 100.0 * share);
  std::printf("memory: %.1f MB at first, %.1f MB after %.0f s\n", memory, residentMegabytes(), seconds);
  loader.clear();
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "measure_camera");
  if (argc != 3) {
    std::fprintf(stderr, "usage: measure_camera <BOP scene or split> <seconds>\n");
    return 2;
  }
  const std::string uri = std::string("virtual:") + argv[1];
  const double seconds = std::stod(argv[2]);
  ros::AsyncSpinner spinner(2);
  spinner.start();
  if (openni::OpenNI::initialize() != openni::STATUS_OK) return 1;
  measureNodelet(uri, seconds, cpuShareOfOpenNi2(uri, std::min(seconds, 30.0)));
  openni::OpenNI::shutdown();
  return 0;
}
