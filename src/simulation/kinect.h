#pragma once

#include <functional>

#include "rgbd_recognition/core/frame.h"
#include "simulation/color_sensor.h"
#include "simulation/depth_sensor.h"

namespace recognition {

enum class ColorMode { kVga, kSxga };  ///< 640x480; 1280x1024 of which depth covers the upper 960 rows

struct KinectParameters {
  ColorMode color_mode = ColorMode::kSxga;
  double color_focal_length = 1050.0;  ///< px at 1280 columns
  int samples = 2;                     ///< rays a pixel and direction for colour
  ColorSensorParameters color;
  DepthSensorParameters depth;

  ParameterList list();

  /// Reads config/sensors/*.yaml: groups "kinect", "color_sensor", "depth_sensor" over the defaults. Throws
  /// std::invalid_argument that names file, group, key and value of anything unknown or out of range.
  static KinectParameters fromYaml(const std::string& file);
  void validate() const;

  /// All groups with all values, as a yaml file would hold them.
  std::string text() const;
};

/// What becomes of an image (CV_32FC3, linear light) while it is exposed, where things move.
using Exposure = std::function<cv::Mat(const cv::Mat& radiance)>;

/// A colour and a depth camera in one, as the first Kinect.
class SimulatedKinect {
 public:
  explicit SimulatedKinect(const KinectParameters& parameters);

  const CameraModel& colorCamera() const { return color_camera_; }
  const CameraModel& depthCamera() const { return depth_camera_; }  ///< registered: colour's at depth resolution

  /// A photograph and its registered depth (CV_16UC1 mm). Same scene and seeds, same bits, for any number of threads.
  /// `seed` draws noise, `camera_seed` what one camera keeps from frame to frame: the level that its automatic exposure
  /// aims at, its balance and tones.
  RgbdFrame capture(const RayScene& scene, std::uint64_t seed, std::uint64_t camera_seed,
                    const Exposure& exposure = nullptr) const;
  RgbdFrame capture(const RayScene& scene, std::uint64_t seed) const { return capture(scene, seed, seed); }

 private:
  KinectParameters parameters_;
  ColorSensor color_sensor_;
  DepthSensor depth_sensor_;
  CameraModel color_camera_;
  CameraModel depth_camera_;
};

}  // namespace recognition
