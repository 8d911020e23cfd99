#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <rgbd_recognition/Openni2CameraConfig.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>

#include "camera/openni2_device.h"
#include "camera/openni2_frames.h"
#include "camera/openni2_stamp_filter.h"
#include "camera/openni2_statistics.h"
#include "camera/openni2_topics.h"
#include "ros/config_ranges.h"
#include "ros/frame_names.h"
#include "ros/parameters.h"

namespace recognition {
namespace {

constexpr Sensor kAllSensors[] = {Sensor::kColor, Sensor::kDepth, Sensor::kInfrared};
constexpr double kReminderPeriod = 30.0;    // s, between repeats of the same complaint
constexpr double kSupervisionPeriod = 0.5;  // s
constexpr char kUdevHint[] = "; is the udev rule for it installed (config/udev/60-rgbd-recognition.rules)?";

size_t indexOf(Sensor sensor) { return static_cast<size_t>(sensor); }

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool isDenied(const std::string& problem) {
  for (const char* sign : {"ermission denied", "ACCESS", "USB_DEVICE_OPEN_FAILED", "open the USB device"}) {
    if (problem.find(sign) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

/// Camera on OpenNI2. One thread, the supervisor, opens, configures, watches and closes the device; the others tell it
/// what changed. Frames are published on their streams' threads.
class OpenNi2CameraNodelet : public nodelet::Nodelet {
 public:
  ~OpenNi2CameraNodelet() override;

 private:
  using Config = rgbd_recognition::Openni2CameraConfig;

  void onInit() override;
  void start();
  void reconfigure(Config& config, uint32_t level);

  // The supervisor's:
  void supervise();
  void step();
  void open();
  void close(const std::string& reason);
  void configure(const Config& config);
  void setMode(Sensor sensor, const std::string& name);
  void runStreams();
  void watch();
  void complain(const std::string& problem);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void describeStreams(diagnostic_updater::DiagnosticStatusWrapper& status);

  void frameArrived(Sensor sensor, const OpenNi2Frame& frame);
  void wake(const std::function<void()>& change = [] {});

  double retry_period_ = 1.0;
  double stall_timeout_ = 5.0;
  std::shared_ptr<StaticFrames> frames_;
  std::unique_ptr<OpenNi2Topics> topics_;
  std::unique_ptr<dynamic_reconfigure::Server<Config>> reconfigure_server_;
  OpenNi2Thread supervisor_;

  std::mutex mutex_;  ///< protects what others tell the supervisor
  std::condition_variable woken_;
  bool awake_ = false;
  bool stopping_ = false;
  bool reconfigured_ = false;
  Config config_ = Config::__getDefault__();
  std::set<std::string> unplugged_uris_;
  double next_attempt_ = 0.0;

  // The supervisor's own:
  std::unique_ptr<DeviceChoice> choice_;
  std::unique_ptr<OpenNi2Session> session_;
  std::unique_ptr<OpenNi2Device> device_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::string problem_;
  std::string warning_;
  double complained_at_ = 0.0;
  bool ir_excluded_ = false;
  Config applied_ = Config::__getDefault__();

  // For the streams' threads:
  std::mutex stamp_mutex_;
  StampFilter stamps_;
  std::array<StreamStatistics, kSensors> statistics_;
  std::atomic<bool> registered_{false};
  std::array<std::atomic<double>, kSensors> time_offsets_{};
};

OpenNi2CameraNodelet::~OpenNi2CameraNodelet() {
  wake([this] { stopping_ = true; });
  supervisor_.join();
}

void OpenNi2CameraNodelet::onInit() {
  try {
    start();
  } catch (const std::exception& error) {
    NODELET_FATAL("%s: %s", getName().c_str(), error.what());
    // The queues that serve these are gone by the time a nodelet that was not loaded is destroyed.
    diagnostics_.reset();
    reconfigure_server_.reset();
    topics_.reset();
    throw;
  }
}

void OpenNi2CameraNodelet::start() {
  ros::NodeHandle& node = getNodeHandle();
  ros::NodeHandle& parameters = getPrivateNodeHandle();
  retry_period_ = parameterOr(parameters, "retry_period", retry_period_);
  stall_timeout_ = parameterOr(parameters, "stall_timeout", stall_timeout_);
  for (const char* mode : {"color_mode", "depth_mode", "ir_mode"}) {
    parseStreamMode(parameterOr<std::string>(parameters, mode, "VGA_30Hz"));
  }
  if (!(retry_period_ > 0.0))
    throw std::invalid_argument("retry_period " + std::to_string(retry_period_) + ": not positive");
  choice_ = std::make_unique<DeviceChoice>(parameterOr<std::string>(parameters, "device_id", ""));
  if (parameterOr(parameters, "publish_tf", true)) {
    frames_ = StaticFrames::shared();
    frames_->addKinect(plainFrame(parameterOr<std::string>(parameters, "camera_name", "camera")));
  }
  topics_ = std::make_unique<OpenNi2Topics>(node, parameters, [this] { wake(); });
  const auto& ranges = ConfigRanges<Config>::get();
  reconfigure_server_ = std::make_unique<dynamic_reconfigure::Server<Config>>(parameters);
  ranges.giveTo(*reconfigure_server_);
  reconfigure_server_->setCallback([this](Config& config, uint32_t level) { reconfigure(config, level); });
  OpenNi2Thread([this] {
    session_ = std::make_unique<OpenNi2Session>(
        [this] { wake([this] { next_attempt_ = 0.0; }); },
        [this](const std::string& uri) { wake([&] { unplugged_uris_.insert(uri); }); });
  }).join();
  diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, parameters, getName());
  diagnostics_->setHardwareID(choice_->description());
  diagnostics_->add("device", this, &OpenNi2CameraNodelet::diagnose);
  supervisor_ = OpenNi2Thread([this] { supervise(); });
}

void OpenNi2CameraNodelet::wake(const std::function<void()>& change) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    change();
    awake_ = true;
  }
  woken_.notify_all();
}

void OpenNi2CameraNodelet::reconfigure(Config& config, uint32_t) {
  try {
    ConfigRanges<Config>::get().require(config);
    for (const std::string& name : {config.color_mode, config.depth_mode, config.ir_mode}) parseStreamMode(name);
  } catch (const std::invalid_argument& error) {
    NODELET_WARN("%s; nothing is changed", error.what());
    const std::lock_guard<std::mutex> lock(mutex_);
    config = config_;
    return;
  }
  wake([&] {
    config_ = config;
    reconfigured_ = true;
  });
}

void OpenNi2CameraNodelet::supervise() {
  while (true) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      woken_.wait_for(lock, std::chrono::duration<double>(kSupervisionPeriod), [this] { return awake_; });
      awake_ = false;
      if (stopping_) break;
    }
    step();
    diagnostics_->update();
  }
  device_.reset();
  session_.reset();
}

void OpenNi2CameraNodelet::step() {
  Config config;
  bool reconfigured = false, attempt = false, unplugged = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    config = config_;
    reconfigured = reconfigured_;
    reconfigured_ = false;
    unplugged = device_ && unplugged_uris_.count(device_->uri()) > 0;
    unplugged_uris_.clear();
    attempt = !device_ && steadySeconds() >= next_attempt_;
    if (attempt) next_attempt_ = steadySeconds() + retry_period_;
  }
  try {
    if (unplugged) close("unplugged");
    if (device_) {
      if (reconfigured) configure(config);
      runStreams();
      watch();
    } else if (attempt) {
      open();
      configure(config);
      runStreams();
    }
  } catch (const std::exception& error) {
    if (device_) close(error.what());
    complain(error.what());
  }
}

void OpenNi2CameraNodelet::open() {
  const std::vector<ListedDevice> listed = session_->list();
  const std::string uri = choice_->find(listed, &OpenNi2Session::serialOf);
  if (uri.empty()) {
    std::string there;
    for (const ListedDevice& device : listed) there += " " + device.uri;
    throw std::runtime_error("waiting for " + choice_->description() +
                             "; plugged in:" + (there.empty() ? " none" : there));
  }
  try {
    device_ = std::make_unique<OpenNi2Device>(
        uri, [this](Sensor sensor, const OpenNi2Frame& frame) { frameArrived(sensor, frame); });
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(error.what() + std::string(isDenied(error.what()) ? kUdevHint : ""));
  }
  choice_->remember(device_->serial());
  std::array<sensor_msgs::CameraInfo, kSensors> cameras;
  for (const Sensor sensor : kAllSensors) {
    if (device_->stream(sensor) != nullptr) cameras[indexOf(sensor)] = device_->stream(sensor)->idealCamera();
  }
  topics_->deviceOpened(device_->serial(), device_->uri().rfind("virtual:", 0) == 0, cameras);
  {
    const std::lock_guard<std::mutex> lock(stamp_mutex_);
    stamps_ = StampFilter();
  }
  problem_.clear();
  diagnostics_->setHardwareID(device_->serial().empty() ? device_->uri() : device_->serial());
  NODELET_INFO("%s: %s opened, serial number '%s'", device_->uri().c_str(), device_->name().c_str(),
               device_->serial().c_str());
}

void OpenNi2CameraNodelet::close(const std::string& reason) {
  NODELET_WARN("%s: closed: %s", device_->uri().c_str(), reason.c_str());
  device_.reset();
  problem_ = reason;
  complained_at_ = steadySeconds();
}

void OpenNi2CameraNodelet::configure(const Config& config) {
  time_offsets_[indexOf(Sensor::kColor)] = config.color_time_offset;
  time_offsets_[indexOf(Sensor::kDepth)] = config.depth_time_offset;
  time_offsets_[indexOf(Sensor::kInfrared)] = config.ir_time_offset;
  device_->run({}, false);
  warning_.clear();
  setMode(Sensor::kColor, config.color_mode);
  setMode(Sensor::kDepth, config.depth_mode);
  setMode(Sensor::kInfrared, config.ir_mode);
  registered_ = device_->setRegistration(config.depth_registration);
  if (registered_ != config.depth_registration) warning_ = "depth registration cannot be changed";
  if (OpenNi2Stream* color = device_->stream(Sensor::kColor)) {
    if (!color->setAutoExposure(config.auto_exposure)) warning_ = "auto exposure cannot be changed";
    if (!color->setAutoWhiteBalance(config.auto_white_balance)) warning_ = "auto white balance cannot be changed";
  }
  for (const Sensor sensor : kAllSensors) {
    if (device_->stream(sensor) != nullptr) device_->stream(sensor)->setMirrored(false);
  }
  if (!warning_.empty()) NODELET_WARN("%s: %s", device_->uri().c_str(), warning_.c_str());
  applied_ = config;
}

void OpenNi2CameraNodelet::setMode(Sensor sensor, const std::string& name) {
  OpenNi2Stream* stream = device_->stream(sensor);
  if (stream == nullptr) return;
  try {
    const StreamMode mode = stream->setMode(parseStreamMode(name));
    if (streamModeName(mode) == name) return;
    NODELET_WARN("%s: no %s at %s, %s instead", device_->uri().c_str(), sensorName(sensor), name.c_str(),
                 streamModeName(mode).c_str());
  } catch (const std::invalid_argument& error) {
    warning_ = std::string(sensorName(sensor)) + ": " + error.what() + "; stays at " + streamModeName(stream->mode());
  }
}

void OpenNi2CameraNodelet::runStreams() {
  std::array<bool, kSensors> wanted;
  for (const Sensor sensor : kAllSensors) wanted[indexOf(sensor)] = topics_->wanted(sensor);
  bool& ir = wanted[indexOf(Sensor::kInfrared)];
  const bool ir_excluded = ir && wanted[indexOf(Sensor::kColor)];  // the devices have one of them at a time
  if (ir_excluded && !ir_excluded_) NODELET_WARN("no infrared images while somebody listens to colour images");
  ir_excluded_ = ir_excluded;
  ir = ir && !ir_excluded;
  if (topics_->misses(registered_)) {
    NODELET_WARN_THROTTLE(kReminderPeriod, "depth_registration is %s: depth is on %s/image_raw",
                          registered_ ? "on" : "off", registered_ ? "depth_registered" : "depth");
  }
  for (const Sensor sensor : kAllSensors) {
    OpenNi2Stream* stream = device_->stream(sensor);
    if (stream != nullptr && wanted[indexOf(sensor)] && !stream->running()) {
      statistics_[indexOf(sensor)].restart(steadySeconds(), stream->mode().rate);
    }
  }
  device_->run(wanted, applied_.color_depth_synchronization);
}

void OpenNi2CameraNodelet::watch() {
  if (!(stall_timeout_ > 0.0)) return;
  for (const Sensor sensor : kAllSensors) {
    const OpenNi2Stream* stream = device_->stream(sensor);
    if (stream == nullptr || !stream->running()) continue;
    const double silence = statistics_[indexOf(sensor)].silence(steadySeconds());
    if (silence > stall_timeout_) {
      throw std::runtime_error(std::string("no ") + sensorName(sensor) + " frame for " + std::to_string(silence) +
                               " s");
    }
  }
}

void OpenNi2CameraNodelet::complain(const std::string& problem) {
  const double now = steadySeconds();
  if (problem == problem_ && now < complained_at_ + kReminderPeriod) return;
  problem_ = problem;
  complained_at_ = now;
  NODELET_WARN("%s", problem.c_str());
}

void OpenNi2CameraNodelet::frameArrived(Sensor sensor, const OpenNi2Frame& frame) {
  const double arrival = ros::Time::now().toSec();
  double stamp = 0.0;
  {
    const std::lock_guard<std::mutex> lock(stamp_mutex_);
    stamp = stamps_.stamp(frame.device_microseconds, arrival);
  }
  statistics_[indexOf(sensor)].count(frame.device_microseconds, steadySeconds());
  stamp = std::max(0.0, stamp + time_offsets_[indexOf(sensor)]);
  topics_->publish(sensor, frame.image, ros::Time(stamp), registered_);
}

void OpenNi2CameraNodelet::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!device_) {
    status.summary(DiagnosticStatus::ERROR, problem_.empty() ? "starting" : problem_);
    return;
  }
  status.summary(DiagnosticStatus::OK, "open");
  if (!warning_.empty()) status.summary(DiagnosticStatus::WARN, warning_);
  status.add("device", device_->name());
  status.add("uri", device_->uri());
  status.add("serial number", device_->serial());
  status.add("depth registered", registered_.load());
  describeStreams(status);
}

void OpenNi2CameraNodelet::describeStreams(diagnostic_updater::DiagnosticStatusWrapper& status) {
  for (const Sensor sensor : kAllSensors) {
    const OpenNi2Stream* stream = device_->stream(sensor);
    if (stream == nullptr) continue;
    const std::string name = sensorName(sensor);
    status.add(name + " mode", streamModeName(stream->mode()));
    status.add(name + " running", stream->running());
    if (!stream->running()) continue;
    const StreamStatistics::Report report = statistics_[indexOf(sensor)].report(steadySeconds());
    status.add(name + " rate", report.rate);
    status.add(name + " frames", report.frames);
    status.add(name + " dropped", report.dropped);
  }
}

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::OpenNi2CameraNodelet, nodelet::Nodelet)
