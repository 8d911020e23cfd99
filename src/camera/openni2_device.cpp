#include "camera/openni2_device.h"

#include <ros/console.h>
#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <mutex>
#include <set>
#include <stdexcept>

#include "camera/openni2_camera_info.h"

namespace recognition {
namespace {

constexpr int kIdealWidth = 640;
constexpr int kIdealHeight = 480;
constexpr double kTypicalFieldOfView = 1.02;  // rad, for devices that do not tell
constexpr int kReadTimeout = 50;              // ms: how long pause() may take

openni::SensorType sensorType(Sensor sensor) {
  switch (sensor) {
    case Sensor::kColor:
      return openni::SENSOR_COLOR;
    case Sensor::kDepth:
      return openni::SENSOR_DEPTH;
    default:
      return openni::SENSOR_IR;
  }
}

/// Of the formats devices have, those that go into a message as they are.
bool isWanted(Sensor sensor, openni::PixelFormat format) {
  switch (sensor) {
    case Sensor::kColor:
      return format == openni::PIXEL_FORMAT_RGB888;
    case Sensor::kDepth:
      return format == openni::PIXEL_FORMAT_DEPTH_1_MM;
    default:
      return format == openni::PIXEL_FORMAT_GRAY16;
  }
}

const char* encodingOf(Sensor sensor) {
  switch (sensor) {
    case Sensor::kColor:
      return sensor_msgs::image_encodings::RGB8.c_str();
    case Sensor::kDepth:
      return sensor_msgs::image_encodings::TYPE_16UC1.c_str();
    default:
      return sensor_msgs::image_encodings::MONO16.c_str();
  }
}

StreamMode streamMode(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY(), mode.getFps()};
}

void check(openni::Status status, const std::string& what) {
  if (status == openni::STATUS_OK) return;
  std::string reason = openni::OpenNI::getExtendedError();
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  throw std::runtime_error(what + ": " + reason);
}

std::string serialOf(openni::Device& device) {
  char serial[256] = {};
  int size = sizeof(serial) - 1;
  const bool known = device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size) == openni::STATUS_OK;
  return known ? serial : "";
}

/// Nobody else in this process gets the device while the result lives.
std::shared_ptr<void> claimDevice(const std::string& uri) {
  static std::mutex mutex;
  static std::set<std::string> claimed;
  const std::lock_guard<std::mutex> lock(mutex);
  if (!claimed.insert(uri).second)
    throw std::runtime_error(uri + ": device busy, another camera of this process has it");
  return std::shared_ptr<void>(nullptr, [uri](void*) {
    const std::lock_guard<std::mutex> lock(mutex);
    claimed.erase(uri);
  });
}

/// OpenNI2 counts who has a device open without a lock, so two cameras of one process must not open or close at a time.
std::mutex& openingMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

const char* sensorName(Sensor sensor) {
  switch (sensor) {
    case Sensor::kColor:
      return "rgb";
    case Sensor::kDepth:
      return "depth";
    default:
      return "ir";
  }
}

OpenNi2Stream::OpenNi2Stream(openni::Device& device, Sensor sensor, Callback callback)
    : sensor_(sensor), callback_(std::move(callback)) {
  check(stream_.create(device, sensorType(sensor)), std::string(sensorName(sensor)) + " stream");
  check(stream_.setFrameBuffersAllocator(&pool_), std::string(sensorName(sensor)) + " stream's frames");
  mode_ = streamMode(stream_.getVideoMode());
}

OpenNi2Stream::~OpenNi2Stream() {
  pause();
  stop();
  stream_.destroy();
}

StreamMode OpenNi2Stream::setMode(const StreamMode& wanted) {
  const auto& modes = stream_.getSensorInfo().getSupportedVideoModes();
  std::vector<StreamMode> available;
  for (int i = 0; i < modes.getSize(); ++i) {
    if (isWanted(sensor_, modes[i].getPixelFormat())) available.push_back(streamMode(modes[i]));
  }
  const StreamMode mode = closestStreamMode(wanted, available);
  const openni::VideoMode now = stream_.getVideoMode();
  if (!isWanted(sensor_, now.getPixelFormat()) || !(streamMode(now) == mode)) {
    for (int i = 0; i < modes.getSize(); ++i) {
      if (!isWanted(sensor_, modes[i].getPixelFormat()) || !(streamMode(modes[i]) == mode)) continue;
      check(stream_.setVideoMode(modes[i]), std::string(sensorName(sensor_)) + " mode " + streamModeName(mode));
      break;
    }
  }
  mode_ = mode;
  return mode;
}

sensor_msgs::CameraInfo OpenNi2Stream::idealCamera() {
  StreamIntrinsics known;
  int size = sizeof(known);
  if (stream_.isPropertySupported(kIntrinsicsProperty) &&
      stream_.getProperty(kIntrinsicsProperty, &known, &size) == openni::STATUS_OK) {
    return scaledCameraInfo(cameraInfoOf(known), kIdealWidth, kIdealHeight);
  }
  const double view = stream_.getHorizontalFieldOfView();
  return defaultCameraInfo(kIdealWidth, kIdealHeight, view > 0.0 ? view : kTypicalFieldOfView);
}

void OpenNi2Stream::start() {
  if (running_) return;
  check(stream_.start(), std::string(sensorName(sensor_)) + " stream");
  running_ = true;
}

void OpenNi2Stream::stop() {
  if (!running_) return;
  stream_.stop();
  running_ = false;
}

void OpenNi2Stream::resume() {
  if (!running_ || reading_) return;
  reading_ = true;
  reader_ = OpenNi2Thread([this] { read(); });
}

void OpenNi2Stream::pause() {
  reading_ = false;
  reader_.join();
}

bool OpenNi2Stream::setAutoExposure(bool on) {
  openni::CameraSettings* settings = stream_.getCameraSettings();
  return settings != nullptr && settings->setAutoExposureEnabled(on) == openni::STATUS_OK;
}

bool OpenNi2Stream::setAutoWhiteBalance(bool on) {
  openni::CameraSettings* settings = stream_.getCameraSettings();
  return settings != nullptr && settings->setAutoWhiteBalanceEnabled(on) == openni::STATUS_OK;
}

void OpenNi2Stream::read() {
  openni::VideoStream* streams[] = {&stream_};
  while (reading_) {
    int ready = -1;
    if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, kReadTimeout) != openni::STATUS_OK) continue;
    openni::VideoFrameRef frame;
    if (stream_.readFrame(&frame) != openni::STATUS_OK || !frame.isValid()) continue;
    try {
      pass(frame);
    } catch (const std::exception& error) {  // the other frames go on
      ROS_ERROR_THROTTLE(5.0, "a frame is lost: %s", error.what());
    }
  }
}

void OpenNi2Stream::pass(const openni::VideoFrameRef& frame) {
  const size_t bytes = static_cast<size_t>(frame.getStrideInBytes()) * frame.getHeight();
  OpenNi2Frame out;
  out.image = pool_.messageOf(frame.getData());
  if (!out.image) {
    out.image = boost::make_shared<sensor_msgs::Image>();
    const auto* data = static_cast<const uint8_t*>(frame.getData());
    out.image->data.assign(data, data + bytes);
  }
  out.image->data.resize(bytes);
  out.image->width = frame.getWidth();
  out.image->height = frame.getHeight();
  out.image->step = frame.getStrideInBytes();
  out.image->encoding = encodingOf(sensor_);
  out.image->is_bigendian = false;
  out.device_microseconds = frame.getTimestamp();
  callback_(out);
}

OpenNi2Device::OpenNi2Device(const std::string& uri, const std::function<void(Sensor, const OpenNi2Frame&)>& callback)
    : claim_(claimDevice(uri)), uri_(uri) {
  {
    const std::lock_guard<std::mutex> lock(openingMutex());
    check(device_.open(uri.c_str()), uri);
  }
  const openni::DeviceInfo& info = device_.getDeviceInfo();
  name_ = std::string(info.getVendor()) + " " + info.getName();
  serial_ = serialOf(device_);
  if (device_.isFile()) device_.getPlaybackControl()->setRepeatEnabled(true);
  for (const Sensor sensor : {Sensor::kColor, Sensor::kDepth, Sensor::kInfrared}) {
    if (!device_.hasSensor(sensorType(sensor))) continue;
    streams_[static_cast<size_t>(sensor)] = std::make_unique<OpenNi2Stream>(
        device_, sensor, [callback, sensor](const OpenNi2Frame& frame) { callback(sensor, frame); });
  }
}

OpenNi2Device::~OpenNi2Device() {
  run({}, false);
  for (auto& stream : streams_) stream.reset();
  const std::lock_guard<std::mutex> lock(openingMutex());
  device_.close();
}

bool OpenNi2Device::setRegistration(bool on) {
  const auto mode = on ? openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR : openni::IMAGE_REGISTRATION_OFF;
  if (device_.isFile()) return on;  // what was recorded cannot be changed, and it is registered as a rule
  if (device_.getImageRegistrationMode() != mode && device_.isImageRegistrationModeSupported(mode)) {
    device_.setImageRegistrationMode(mode);
  }
  return device_.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
}

// OpenNI2 exchanges what a stream's frames wait in whenever streams start or stop while it synchronises, or when it
// begins to, and does not mind readers: so nobody reads meanwhile, and it synchronises only once all streams run.
void OpenNi2Device::run(const std::array<bool, kSensors>& wanted, bool sync) {
  bool all_fit = isPaired(sync) == paired_;
  for (size_t i = 0; i < kSensors; ++i) all_fit = all_fit && (!streams_[i] || streams_[i]->running() == wanted[i]);
  if (all_fit) return;
  for (auto& stream : streams_) {
    if (stream) stream->pause();
  }
  if (paired_) device_.setDepthColorSyncEnabled(false);
  for (size_t i = 0; i < kSensors; ++i) {
    if (streams_[i] && !wanted[i]) streams_[i]->stop();
  }
  std::string problem;
  for (size_t i = 0; i < kSensors; ++i) {
    try {
      if (streams_[i] && wanted[i]) streams_[i]->start();
    } catch (const std::runtime_error& error) {
      if (problem.empty()) problem = error.what();
    }
  }
  paired_ = isPaired(sync);
  if (paired_) device_.setDepthColorSyncEnabled(true);
  for (auto& stream : streams_) {
    if (stream) stream->resume();
  }
  if (!problem.empty()) throw std::runtime_error(problem);
}

bool OpenNi2Device::isPaired(bool sync) const {
  const auto& color = streams_[static_cast<size_t>(Sensor::kColor)];
  const auto& depth = streams_[static_cast<size_t>(Sensor::kDepth)];
  return sync && !device_.isFile() && color && depth && color->running() && depth->running() &&
         color->mode().rate == depth->mode().rate;
}

OpenNi2Session::OpenNi2Session(std::function<void()> come, std::function<void(const std::string&)> gone)
    : come_(std::move(come)), gone_(std::move(gone)) {
  check(openni::OpenNI::initialize(), "OpenNI2");
  openni::OpenNI::addDeviceConnectedListener(this);
  openni::OpenNI::addDeviceDisconnectedListener(this);
}

OpenNi2Session::~OpenNi2Session() {
  openni::OpenNI::removeDeviceConnectedListener(this);
  openni::OpenNI::removeDeviceDisconnectedListener(this);
  openni::OpenNI::shutdown();
}

std::vector<ListedDevice> OpenNi2Session::list() const {
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  std::vector<ListedDevice> listed;
  for (int i = 0; i < devices.getSize(); ++i) {
    listed.push_back({devices[i].getUri(), std::string(devices[i].getVendor()) + " " + devices[i].getName()});
  }
  return listed;
}

std::string OpenNi2Session::serialOf(const std::string& uri) {
  const std::lock_guard<std::mutex> lock(openingMutex());
  openni::Device device;
  return device.open(uri.c_str()) == openni::STATUS_OK ? recognition::serialOf(device) : "";
}

}  // namespace recognition
