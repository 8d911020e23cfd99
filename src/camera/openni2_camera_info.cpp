#include "camera/openni2_camera_info.h"

#include <sensor_msgs/distortion_models.h>

#include <cmath>

namespace recognition {

sensor_msgs::CameraInfo defaultCameraInfo(int width, int height, double horizontal_field_of_view) {
  const double focal_length = 0.5 * width / std::tan(0.5 * horizontal_field_of_view);
  sensor_msgs::CameraInfo info =
      cameraInfoOf({width, focal_length, focal_length, 0.5 * width - 0.5, 0.5 * (0.75 * width) - 0.5});
  info.height = height;
  return info;
}

sensor_msgs::CameraInfo cameraInfoOf(const StreamIntrinsics& camera) {
  sensor_msgs::CameraInfo info;
  info.width = info.height = camera.width;
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(5, 0.0);
  info.K = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

sensor_msgs::CameraInfo scaledCameraInfo(const sensor_msgs::CameraInfo& calibration, int width, int height) {
  sensor_msgs::CameraInfo info = calibration;
  info.width = width;
  info.height = height;
  if (calibration.width == 0 || static_cast<int>(calibration.width) == width) return info;
  const double scale = static_cast<double>(width) / calibration.width;
  for (const size_t row : {0, 1}) {
    for (size_t i = 0; i < 3; ++i) info.K[3 * row + i] *= scale;
    for (size_t i = 0; i < 4; ++i) info.P[4 * row + i] *= scale;
    const double shift = 0.5 * (scale - 1.0);  // integers are pixel centres
    info.K[3 * row + 2] += shift;
    info.P[4 * row + 2] += shift;
  }
  return info;
}

sensor_msgs::CameraInfo projectorInfo(const sensor_msgs::CameraInfo& infrared, double baseline) {
  sensor_msgs::CameraInfo info = infrared;
  info.P[3] = -baseline * info.P[0];
  return info;
}

}  // namespace recognition
