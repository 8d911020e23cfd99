#include "openni2/virtual_device.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "openni2/driver_property.h"

namespace recognition::openni2 {
namespace {

constexpr int kRate = 30;            // Hz
constexpr int kMaxKeptImages = 300;  // a sensor: ten seconds, 280 MB of VGA colour

std::vector<OniVideoMode> modesOf(OniPixelFormat format, bool with_sxga) {
  std::vector<OniVideoMode> modes;
  for (int fps : {30, 15}) {
    modes.push_back(videoMode(format, 640, 480, fps));
    modes.push_back(videoMode(format, 320, 240, fps));
    if (with_sxga) modes.push_back(videoMode(format, 1280, 1024, fps));
  }
  return modes;
}

int lockPlugFile(const VirtualPlug& plug) {
  if (plug.lock_file.empty()) return -1;
  const int file = open(plug.lock_file.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw std::runtime_error(plug.uri + ": " + std::strerror(errno));
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  close(file);
  throw std::runtime_error(plug.uri + ": device busy, another program has it open");
}

}  // namespace

VirtualDevice::VirtualDevice(const VirtualPlug& plug) : plug_(plug) {
  if (plug.access_denied) throw std::runtime_error(plug.uri + ": permission denied");
  recording_ = std::make_unique<VirtualRecording>(plug.source);
  lock_ = lockPlugFile(plug);
  sensors_.add(ONI_SENSOR_COLOR, modesOf(ONI_PIXEL_FORMAT_RGB888, true));
  sensors_.add(ONI_SENSOR_DEPTH, modesOf(ONI_PIXEL_FORMAT_DEPTH_1_MM, false));
  sensors_.add(ONI_SENSOR_IR, modesOf(ONI_PIXEL_FORMAT_GRAY16, false));
  thread_ = std::thread(&VirtualDevice::run, this);
}

VirtualDevice::~VirtualDevice() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  thread_.join();
  if (lock_ >= 0) close(lock_);
}

oni::driver::StreamBase* VirtualDevice::createStream(OniSensorType sensor) {
  return new VirtualStream(this, sensor, recording_->colorCamera(), sensors_.modes(sensor));
}

void VirtualDevice::destroyStream(oni::driver::StreamBase* stream) {
  auto* own = static_cast<VirtualStream*>(stream);
  stop(own);
  delete own;
}

OniStatus VirtualDevice::getProperty(int id, void* data, int* size) {
  switch (id) {
    case ONI_DEVICE_PROPERTY_SERIAL_NUMBER:
      return readTextProperty(plug_.serial.c_str(), data, size);
    case ONI_DEVICE_PROPERTY_FIRMWARE_VERSION:
      return readTextProperty("virtual", data, size);
    case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
      return readProperty(OniVersion{1, 0, 0, 0}, data, size);
    case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION: {
      const std::lock_guard<std::mutex> lock(mutex_);
      return readProperty(registered_ ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF, data, size);
    }
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus VirtualDevice::setProperty(int id, const void* data, int size) {
  if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
  OniImageRegistrationMode wanted;
  const OniStatus status = writeProperty(&wanted, data, size);
  if (status != ONI_STATUS_OK) return status;
  const std::lock_guard<std::mutex> lock(mutex_);
  registered_ = wanted == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  images_[ONI_SENSOR_DEPTH].clear();
  return ONI_STATUS_OK;
}

OniBool VirtualDevice::isPropertySupported(int id) {
  return id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER || id == ONI_DEVICE_PROPERTY_FIRMWARE_VERSION ||
         id == ONI_DEVICE_PROPERTY_DRIVER_VERSION || id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
}

void VirtualDevice::unplug() {
  const std::lock_guard<std::mutex> lock(mutex_);
  plugged_ = false;
}

bool VirtualDevice::start(VirtualStream* stream) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!plugged_) return false;
  const auto excludes = [stream](const VirtualStream* other) {
    return (stream->sensor() == ONI_SENSOR_IR && other->sensor() == ONI_SENSOR_COLOR) ||
           (stream->sensor() == ONI_SENSOR_COLOR && other->sensor() == ONI_SENSOR_IR);
  };
  if (std::any_of(running_.begin(), running_.end(), excludes)) return false;
  try {
    for (int i = 0; i < std::min(recording_->size(), kMaxKeptImages); ++i) image(*stream, i);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "virtual Kinect: %s\n", error.what());
    return false;
  }
  running_.push_back(stream);
  changed_.notify_all();
  return true;
}

void VirtualDevice::stop(VirtualStream* stream) {
  std::unique_lock<std::mutex> lock(mutex_);
  running_.erase(std::remove(running_.begin(), running_.end(), stream), running_.end());
  changed_.wait(lock, [&] { return delivering_ != stream; });
}

bool VirtualDevice::isRunning(const VirtualStream* stream) const {
  return std::find(running_.begin(), running_.end(), stream) != running_.end();
}

cv::Mat VirtualDevice::image(const DriverStream& stream, int tick) {
  const int index = tick % recording_->size();
  std::map<int, cv::Mat>& kept = images_[stream.sensor()];
  const auto found = kept.find(index);
  if (found != kept.end()) return found->second;
  if (static_cast<int>(kept.size()) >= kMaxKeptImages) kept.erase(std::prev(kept.end()));
  const VirtualRecording::Images images = recording_->load(index);
  const int width = stream.mode().resolutionX;
  const int height = stream.mode().resolutionY;
  cv::Mat& image = kept[index];
  if (stream.sensor() == ONI_SENSOR_COLOR) image = colorImage(images, width, height);
  if (stream.sensor() == ONI_SENSOR_IR) image = infraredImage(images, width, height);
  if (stream.sensor() == ONI_SENSOR_DEPTH) image = depthImage(images, width, height, registered_);
  if (!image.isContinuous()) image = image.clone();
  return image;
}

bool VirtualDevice::prepareMode(const VirtualStream& stream) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (isRunning(&stream) || delivering_ == &stream) return false;
  images_[stream.sensor()].clear();
  return true;
}

void VirtualDevice::run() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::nanoseconds period(1000000000 / kRate);
  const Clock::time_point start = Clock::now();
  std::unique_lock<std::mutex> lock(mutex_);
  while (!closing_) {
    if (running_.empty() || !plugged_) {
      changed_.wait(lock);
      continue;
    }
    const int tick = static_cast<int>((Clock::now() - start) / period) + 1;
    if (changed_.wait_until(lock, start + tick * period, [this] { return closing_; })) return;
    deliver(tick, &lock);
  }
}

void VirtualDevice::deliver(int tick, std::unique_lock<std::mutex>* lock) {
  for (VirtualStream* stream : std::vector<VirtualStream*>(running_)) {
    if (closing_ || !plugged_ || !isRunning(stream) || !stream->hasFrame(tick)) continue;
    cv::Mat pixels;
    try {
      pixels = image(*stream, tick);
    } catch (const std::exception& error) {  // the other frames go on
      std::fprintf(stderr, "virtual Kinect: %s; frame skipped\n", error.what());
      continue;
    }
    delivering_ = stream;
    lock->unlock();
    stream->play(tick, pixels);
    lock->lock();
    delivering_ = nullptr;
    changed_.notify_all();
  }
}

OniStatus VirtualStream::getProperty(int id, void* data, int* size) {
  return id == kIntrinsicsProperty ? readProperty(intrinsics_, data, size) : DriverStream::getProperty(id, data, size);
}

bool VirtualStream::hasFrame(int tick) const { return tick % (kRate / mode().fps) == 0; }

void VirtualStream::play(int tick, const cv::Mat& image) {
  OniFrame* frame = newFrame(static_cast<uint64_t>(tick) * 1000000 / kRate, tick);
  if (frame == nullptr) return;
  std::memcpy(frame->data, image.data, image.total() * image.elemSize());
  deliver(frame);
}

}  // namespace recognition::openni2
