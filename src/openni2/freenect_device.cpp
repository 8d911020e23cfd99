#include "openni2/freenect_device.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "openni2/depth_warp.h"
#include "openni2/driver_property.h"
#include "openni2/kinect_depth.h"

// libfreenect's stand-in that replays recordings (fakenect) lacks this one.
#pragma weak freenect_set_flag

namespace recognition::openni2 {
namespace {

bool isVideo(const FreenectStream& stream) { return stream.sensor() != ONI_SENSOR_DEPTH; }

freenect_video_format videoFormat(OniSensorType sensor) {
  return sensor == ONI_SENSOR_IR ? FREENECT_VIDEO_IR_10BIT : FREENECT_VIDEO_RGB;
}

/// The library's modes of this format as OpenNI2 wants them: infrared images lose the rows beyond 480.
std::vector<OniVideoMode> videoModes(OniSensorType sensor) {
  const OniPixelFormat format = sensor == ONI_SENSOR_IR ? ONI_PIXEL_FORMAT_GRAY16 : ONI_PIXEL_FORMAT_RGB888;
  std::vector<OniVideoMode> modes;
  for (int i = 0; i < freenect_get_video_mode_count(); ++i) {
    const freenect_frame_mode mode = freenect_get_video_mode(i);
    if (mode.video_format != videoFormat(sensor)) continue;
    modes.push_back(videoMode(format, mode.width, mode.width == 640 ? 480 : mode.height, mode.framerate));
  }
  std::sort(modes.begin(), modes.end(),
            [](const OniVideoMode& a, const OniVideoMode& b) { return a.resolutionX < b.resolutionX; });
  return modes;
}

bool hasDepthFormat(freenect_depth_format format) {
  for (int i = 0; i < freenect_get_depth_mode_count(); ++i) {
    if (freenect_get_depth_mode(i).depth_format == format) return true;
  }
  return false;
}

std::string reasonOf(const std::string& complaints) {
  if (complaints.find("-3") != std::string::npos || complaints.find("ACCESS") != std::string::npos) {
    return "permission denied";
  }
  if (complaints.find("-6") != std::string::npos || complaints.find("BUSY") != std::string::npos) {
    return "device busy, another program has it open";
  }
  return complaints.empty() ? "cannot be opened" : complaints;
}

}  // namespace

FreenectDevice::FreenectDevice(FreenectThread* thread, const FreenectAddress& address)
    : thread_(*thread), address_(address) {
  std::string complaints;
  thread_.call([&] {
    thread_.takeComplaints();
    const int status = address_.serial.empty() ? freenect_open_device(thread_.context(), &device_, address_.index)
                                               : freenect_open_device_by_camera_serial(thread_.context(), &device_,
                                                                                       address_.serial.c_str());
    if (status < 0) device_ = nullptr;
    complaints = thread_.takeComplaints();
    if (device_ == nullptr) return;
    freenect_set_user(device_, this);
    freenect_set_depth_callback(device_, [](freenect_device* device, void* pixels, uint32_t ticks) {
      static_cast<FreenectDevice*>(freenect_get_user(device))->depthArrived(pixels, ticks);
    });
    freenect_set_video_callback(device_, [](freenect_device* device, void* pixels, uint32_t ticks) {
      static_cast<FreenectDevice*>(freenect_get_user(device))->videoArrived(pixels, ticks);
    });
  });
  if (device_ == nullptr) throw std::runtime_error(address_.uri + ": " + reasonOf(complaints));
  sensors_.add(ONI_SENSOR_COLOR, videoModes(ONI_SENSOR_COLOR));
  sensors_.add(ONI_SENSOR_DEPTH, {videoMode(ONI_PIXEL_FORMAT_DEPTH_1_MM, 640, 480, 30)});
  if (!videoModes(ONI_SENSOR_IR).empty()) sensors_.add(ONI_SENSOR_IR, videoModes(ONI_SENSOR_IR));
}

FreenectDevice::~FreenectDevice() {
  thread_.call([this] {
    for (FreenectStream* stream : {depth_, video_}) {
      if (stream != nullptr) stopNow(stream);
    }
    freenect_close_device(device_);
  });
}

oni::driver::StreamBase* FreenectDevice::createStream(OniSensorType sensor) {
  std::vector<OniVideoMode> modes = sensors_.modes(sensor);
  if (modes.empty()) return nullptr;
  const CameraModel camera = sensor == ONI_SENSOR_COLOR ? typicalColorCamera() : typicalInfraredCamera();
  const FieldOfView view = fieldOfView(camera.width, camera.height, camera.fx, camera.fy);
  return new FreenectStream(this, sensor, view, std::move(modes));
}

void FreenectDevice::destroyStream(oni::driver::StreamBase* stream) {
  auto* own = static_cast<FreenectStream*>(stream);
  stop(own);
  delete own;
}

OniStatus FreenectDevice::getProperty(int id, void* data, int* size) {
  switch (id) {
    case ONI_DEVICE_PROPERTY_SERIAL_NUMBER:
      return readTextProperty(address_.serial.c_str(), data, size);
    case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
      return readProperty(OniVersion{1, 0, 0, 0}, data, size);
    case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION: {
      bool registered = false;
      thread_.call([&] { registered = registered_; });
      return readProperty(registered ? ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR : ONI_IMAGE_REGISTRATION_OFF, data, size);
    }
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus FreenectDevice::setProperty(int id, const void* data, int size) {
  if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
  OniImageRegistrationMode wanted;
  const OniStatus status = writeProperty(&wanted, data, size);
  if (status != ONI_STATUS_OK) return status;
  bool done = true;
  thread_.call([&] {
    registered_ = wanted == ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (depth_ == nullptr) return;
    FreenectStream* stream = depth_;
    stopNow(stream);
    done = startDepth(stream);
  });
  return done ? ONI_STATUS_OK : ONI_STATUS_ERROR;
}

OniBool FreenectDevice::isPropertySupported(int id) {
  return id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER || id == ONI_DEVICE_PROPERTY_DRIVER_VERSION ||
         id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
}

bool FreenectDevice::start(FreenectStream* stream) {
  bool started = false;
  thread_.call([&] { started = isVideo(*stream) ? startVideo(stream) : startDepth(stream); });
  return started;
}

void FreenectDevice::stop(FreenectStream* stream) {
  thread_.call([&] {
    if (stream == depth_ || stream == video_) stopNow(stream);
  });
}

bool FreenectDevice::startDepth(FreenectStream* stream) {
  const freenect_depth_format wanted = registered_ ? FREENECT_DEPTH_REGISTERED : FREENECT_DEPTH_MM;
  depth_format_ = hasDepthFormat(wanted) ? wanted : FREENECT_DEPTH_11BIT;
  if (freenect_set_depth_mode(device_, freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, depth_format_)) < 0 ||
      freenect_start_depth(device_) < 0) {
    return false;
  }
  depth_ = stream;
  stream->running_ = true;
  thread_.countStream(1);
  return true;
}

bool FreenectDevice::startVideo(FreenectStream* stream) {
  if (video_ != nullptr) return false;  // colour and infrared share the camera's USB endpoint
  const freenect_resolution resolution =
      stream->mode().resolutionX == 640 ? FREENECT_RESOLUTION_MEDIUM : FREENECT_RESOLUTION_HIGH;
  const freenect_video_format format = videoFormat(stream->sensor());
  if (freenect_set_video_mode(device_, freenect_find_video_mode(resolution, format)) < 0 ||
      freenect_start_video(device_) < 0) {
    return false;
  }
  video_ = stream;
  stream->running_ = true;
  thread_.countStream(1);
  return true;
}

void FreenectDevice::stopNow(FreenectStream* stream) {
  if (stream == depth_) {
    freenect_stop_depth(device_);
    depth_ = nullptr;
  } else {
    freenect_stop_video(device_);
    video_ = nullptr;
  }
  stream->running_ = false;
  thread_.countStream(-1);
}

bool FreenectDevice::setFlag(freenect_flag flag, bool on) {
  if (&freenect_set_flag == nullptr) return false;
  int status = -1;
  thread_.call([&] { status = freenect_set_flag(device_, flag, on ? FREENECT_ON : FREENECT_OFF); });
  return status >= 0;
}

void FreenectDevice::depthArrived(const void* pixels, uint32_t ticks) {
  if (depth_ == nullptr) return;
  const int64_t microseconds = clock_.microseconds(ticks);
  if (depth_format_ != FREENECT_DEPTH_11BIT) return depth_->send(pixels, microseconds);
  cv::Mat raw(480, 640, CV_16UC1);
  std::memcpy(raw.data, pixels, raw.total() * raw.elemSize());  // fakenect's begin at an odd address
  cv::Mat depth = millimetresOfRaw(raw);
  if (registered_) {
    depth = warpDepth(depth, typicalInfraredCamera(), typicalColorCamera(), -kColorCameraRightOfInfrared);
  }
  depth_->send(depth.data, microseconds);
}

void FreenectDevice::videoArrived(const void* pixels, uint32_t ticks) {
  if (video_ != nullptr) video_->send(pixels, clock_.microseconds(ticks));
}

void FreenectStream::send(const void* pixels, int64_t microseconds) {
  OniFrame* frame =
      newFrame(static_cast<uint64_t>(std::max<int64_t>(microseconds, 0)), KinectClock::frameIndex(microseconds));
  if (frame == nullptr) return;
  std::memcpy(frame->data, pixels, static_cast<size_t>(frame->stride) * frame->height);
  deliver(frame);
}

}  // namespace recognition::openni2
