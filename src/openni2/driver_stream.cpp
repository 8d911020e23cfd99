#include "openni2/driver_stream.h"

#include <algorithm>
#include <cmath>

#include "openni2/driver_property.h"

namespace recognition::openni2 {
namespace {

constexpr int kMaxDepth = 10000;  // millimetres
constexpr int kMaxColor = 255;

int bytesPerPixel(OniPixelFormat format) {
  if (format == ONI_PIXEL_FORMAT_RGB888) return 3;
  return format == ONI_PIXEL_FORMAT_GRAY8 ? 1 : 2;
}

template <int bytes>
void mirrorRowsOf(void* pixels, int width, int height) {
  struct Pixel {
    unsigned char bytes_[bytes];
  };
  Pixel* row = static_cast<Pixel*>(pixels);
  for (int y = 0; y < height; ++y, row += width) std::reverse(row, row + width);
}

}  // namespace

FieldOfView fieldOfView(int width, int height, double fx, double fy) {
  return {static_cast<float>(2.0 * std::atan(0.5 * width / fx)),
          static_cast<float>(2.0 * std::atan(0.5 * height / fy))};
}

bool isSameMode(const OniVideoMode& a, const OniVideoMode& b) {
  return a.pixelFormat == b.pixelFormat && a.resolutionX == b.resolutionX && a.resolutionY == b.resolutionY &&
         a.fps == b.fps;
}

OniVideoMode videoMode(OniPixelFormat format, int width, int height, int fps) {
  OniVideoMode mode;
  mode.pixelFormat = format;
  mode.resolutionX = width;
  mode.resolutionY = height;
  mode.fps = fps;
  return mode;
}

void mirrorRows(void* pixels, int width, int height, int bytes_per_pixel) {
  if (bytes_per_pixel == 1) mirrorRowsOf<1>(pixels, width, height);
  if (bytes_per_pixel == 2) mirrorRowsOf<2>(pixels, width, height);
  if (bytes_per_pixel == 3) mirrorRowsOf<3>(pixels, width, height);
}

DriverStream::DriverStream(OniSensorType sensor, FieldOfView field_of_view, std::vector<OniVideoMode> modes)
    : sensor_(sensor), field_of_view_(field_of_view), modes_(std::move(modes)), mode_(modes_.front()) {}

OniStatus DriverStream::getProperty(int id, void* data, int* size) {
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return readProperty(mode_, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return readProperty(field_of_view_.horizontal, data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return readProperty(field_of_view_.vertical, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return readProperty(sensor_ == ONI_SENSOR_DEPTH ? kMaxDepth : kMaxColor, data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
      return readProperty(0, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return readProperty(mode_.resolutionX * bytesPerPixel(mode_.pixelFormat), data, size);
    case ONI_STREAM_PROPERTY_CROPPING:
      return readProperty(OniCropping{}, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return readProperty(mirrored_.load(), data, size);
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      return readProperty(auto_exposure_, data, size);
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      return readProperty(auto_white_balance_, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus DriverStream::setProperty(int id, const void* data, int size) {
  switch (id) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return setMode(data, size);
    case ONI_STREAM_PROPERTY_MIRRORING: {
      OniBool mirrored = FALSE;
      const OniStatus status = writeProperty(&mirrored, data, size);
      if (status == ONI_STATUS_OK) mirrored_ = mirrored;
      return status;
    }
    case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      return setSwitch(&auto_exposure_, &DriverStream::changeAutoExposure, data, size);
    case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      return setSwitch(&auto_white_balance_, &DriverStream::changeAutoWhiteBalance, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus DriverStream::setMode(const void* data, int size) {
  OniVideoMode wanted;
  if (writeProperty(&wanted, data, size) != ONI_STATUS_OK) return ONI_STATUS_BAD_PARAMETER;
  const auto is_wanted = [&wanted](const OniVideoMode& mode) { return isSameMode(mode, wanted); };
  if (std::none_of(modes_.begin(), modes_.end(), is_wanted)) return ONI_STATUS_NOT_SUPPORTED;
  if (!changeMode(wanted)) return ONI_STATUS_ERROR;
  mode_ = wanted;
  return ONI_STATUS_OK;
}

OniStatus DriverStream::setSwitch(OniBool* value, bool (DriverStream::*change)(bool), const void* data, int size) {
  OniBool wanted;
  if (writeProperty(&wanted, data, size) != ONI_STATUS_OK) return ONI_STATUS_BAD_PARAMETER;
  if (!(this->*change)(wanted != FALSE)) return ONI_STATUS_NOT_SUPPORTED;
  *value = wanted;
  return ONI_STATUS_OK;
}

OniBool DriverStream::isPropertySupported(int id) {
  if (id == ONI_STREAM_PROPERTY_AUTO_EXPOSURE || id == ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE)
    return sensor_ == ONI_SENSOR_COLOR;
  return id == ONI_STREAM_PROPERTY_CROPPING ||
         (id >= ONI_STREAM_PROPERTY_HORIZONTAL_FOV && id <= ONI_STREAM_PROPERTY_MIRRORING);
}

void DriverStream::notifyAllProperties() {
  for (int id = ONI_STREAM_PROPERTY_CROPPING; id <= ONI_STREAM_PROPERTY_AUTO_EXPOSURE; ++id) {
    if (!isPropertySupported(id)) continue;
    unsigned char value[sizeof(OniCropping)];
    for (int size : {sizeof(int), sizeof(OniVideoMode), sizeof(OniCropping)}) {
      if (getProperty(id, value, &size) == ONI_STATUS_OK) raisePropertyChanged(id, value, size);
    }
  }
}

OniFrame* DriverStream::newFrame(uint64_t timestamp_us, int index) {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return nullptr;
  frame->sensorType = sensor_;
  frame->timestamp = timestamp_us;
  frame->frameIndex = index;
  frame->videoMode = mode_;
  frame->width = mode_.resolutionX;
  frame->height = mode_.resolutionY;
  frame->stride = mode_.resolutionX * bytesPerPixel(mode_.pixelFormat);
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = frame->cropOriginY = 0;
  return frame;
}

void DriverStream::deliver(OniFrame* frame) {
  if (mirrored_) mirrorRows(frame->data, frame->width, frame->height, bytesPerPixel(frame->videoMode.pixelFormat));
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

void SensorList::add(OniSensorType sensor, std::vector<OniVideoMode> modes) {
  modes_.push_back(std::move(modes));
  OniSensorInfo info;
  info.sensorType = sensor;
  sensors_.push_back(info);
}

OniStatus SensorList::get(OniSensorInfo** sensors, int* count) {
  for (size_t i = 0; i < sensors_.size(); ++i) {
    sensors_[i].numSupportedVideoModes = static_cast<int>(modes_[i].size());
    sensors_[i].pSupportedVideoModes = modes_[i].data();
  }
  *sensors = sensors_.data();
  *count = static_cast<int>(sensors_.size());
  return ONI_STATUS_OK;
}

std::vector<OniVideoMode> SensorList::modes(OniSensorType sensor) const {
  for (size_t i = 0; i < sensors_.size(); ++i) {
    if (sensors_[i].sensorType == sensor) return modes_[i];
  }
  return {};
}

}  // namespace recognition::openni2
