#pragma once

#include <cstdint>

#include "rgbd_recognition/core/parameters.h"
#include "simulation/structured_light.h"

namespace recognition {

/// A structured-light depth camera of the first Kinect's kind.
///
/// Disparity d = f b / z. Axial noise: sigma_z = (m / (f b)) sigma_d z^2 with a disparity unit of 1/8 px and sigma_d =
/// 0.5 units, quantisation included (Khoshelham and Elberink, Sensors 2012, eq. 10 and Sec. 4). Growth of axial noise
/// with the angle of incidence and lateral noise at edges: Nguyen, Izadi and Lovell, 3DIMPVT 2012, Sec. 3. A pixel gets
/// its disparity from a correlation window: what fills most of the lit window wins (so foreground spreads into the
/// projector's shadow and edges wander), and a window with too little lit agreement is lost.
struct DepthSensorParameters {
  int width = 640;  ///< px
  int height = 480;
  double focal_length = 580.0;         ///< px, infrared camera
  double baseline = 0.075;             ///< m, infrared camera to projector (to the right)
  double color_offset = 0.025;         ///< m, infrared camera to colour camera (to the right)
  double subpixel = 8.0;               ///< disparity steps a pixel
  double disparity_noise = 0.5;        ///< steps, standard deviation with quantisation
  double noise_correlation = 1.2;      ///< px, the window's smoothing of that noise
  double angular_noise = 0.0001;       ///< m, Nguyen: factor of theta^2 / (pi/2 - theta)^2 / sqrt(z)
  double lateral_noise = 0.8;          ///< px, Nguyen: standard deviation of edges seen straight on
  double lateral_noise_slope = 0.035;  ///< px, Nguyen: factor of theta / (pi/2 - theta)
  double lateral_correlation = 2.0;    ///< px along edges
  double bias = 0.9;                   ///< steps, standard deviation of a smooth error over the image
  double bias_length = 60.0;           ///< px, its correlation length
  int window = 7;                      ///< px, correlation window's side
  double same_surface = 0.6;           ///< px of disparity within which a window's pixels support one another
  double min_support = 0.42;           ///< share of the window that must be lit and agree
  double support_noise = 0.15;         ///< relative standard deviation of the support
  double half_signal = 0.02;           ///< signal (reflectance cos / z^2) that halves the support
  double glare_limit = 0.12;           ///< mirrored projector light that blinds a pixel
  double min_depth = 0.4;              ///< m
  double max_depth = 5.0;              ///< m
  double scale = 1.0;                  ///< reported depth over true depth: an error of calibration
  double registration_x = 0.0;         ///< px to the right that depth lies beside colour: another such error
  double registration_y = 0.0;         ///< px down

  ParameterList list();
  void validate() const;
};

class DepthSensor {
 public:
  explicit DepthSensor(const DepthSensorParameters& parameters);

  const CameraModel& camera() const { return camera_; }  ///< infrared
  double baseline() const { return parameters_.baseline; }

  /// The infrared camera's pose for a colour camera's: parallel, `color_offset` to its left.
  Pose worldFromInfrared(const Pose& world_from_color) const;

  /// Measured depth in the infrared camera, CV_32FC1 metres, 0 invalid. Same seed, same bits, for any number of
  /// threads.
  cv::Mat measure(const StructuredLightView& view, std::uint64_t seed) const;

  /// Depth moved into the colour camera's view, nearest wins; `target` has depth resolution. CV_16UC1 millimetres, 0
  /// invalid.
  cv::Mat registerToColor(const cv::Mat& depth, const CameraModel& target) const;

 private:
  /// A pixel's share of the noise fields, each of unit variance.
  struct Draws {
    cv::Vec2f wander;
    float noise;
    float bias;
    float doubt;
  };

  cv::Mat trueDisparity(const StructuredLightView& view) const;
  double extrapolate(const StructuredLightView& view, cv::Point source, const Eigen::Vector3d& ray) const;
  double quantised(double z, double theta, double noise, double bias) const;
  float measurePixel(const StructuredLightView& view, const cv::Mat& disparity, cv::Point pixel,
                     const Draws& draws) const;

  DepthSensorParameters parameters_;
  CameraModel camera_;
};

}  // namespace recognition
