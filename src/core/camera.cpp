#include "rgbd_recognition/core/camera.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "core/short_number.h"

namespace recognition {

CameraModel CameraModel::scaled(double factor) const {
  CameraModel camera;
  camera.width = static_cast<int>(std::lround(width * factor));
  camera.height = static_cast<int>(std::lround(height * factor));
  camera.fx = fx * factor;
  camera.fy = fy * factor;
  camera.cx = (cx + 0.5) * factor - 0.5;
  camera.cy = (cy + 0.5) * factor - 0.5;
  return camera;
}

void CameraModel::validate() const {
  const auto check = [](bool good, const char* name, double value) {
    if (!good) throw std::invalid_argument(std::string("camera: ") + name + " is " + shortNumber(value));
  };
  check(width > 0, "width", width);
  check(height > 0, "height", height);
  check(std::isfinite(fx) && fx > 0, "fx", fx);
  check(std::isfinite(fy) && fy > 0, "fy", fy);
  check(std::isfinite(cx), "cx", cx);
  check(std::isfinite(cy), "cy", cy);
}

}  // namespace recognition
