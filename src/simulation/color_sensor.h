#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// A small Bayer-pattern camera with automatic exposure and white balance. Pixels of the full-resolution image; smaller
/// modes scale the blur. Sources of the numbers: config/sensors/kinect_sxga.yaml.
struct ColorSensorParameters {
  double blur = 0.5;              ///< px, standard deviation of lens and motion
  double full_well = 9500.0;      ///< electrons at saturation without gain
  double read_noise = 9.0;        ///< electrons
  double max_gain = 10.0;         ///< analogue gain in the darkest scenes
  double longest_exposure = 1.2;  ///< level that 1 klx from a white surface gives in the longest exposure without gain
  double mean_level_min = 0.13;   ///< linear mean that automatic exposure aims at, drawn per scene
  double mean_level_max = 0.55;
  double white_balance_min = 0.3;  ///< share of the lamps' tint that automatic white balance removes, drawn per scene
  double white_balance_max = 0.9;
  double white_balance_error = 0.08;  ///< standard deviation of the logarithm of the red and blue gains
  double saturation_min = 1.2;        ///< factor on chroma (linear light), drawn per scene
  double saturation_max = 1.9;
  double contrast_max = 0.8;  ///< weight of an S-shaped tone curve, drawn per scene from 0
  double gamma = 2.2;
  double chroma_blur = 1.0;  ///< px, standard deviation of what chroma subsampling leaves
  double sharpening = 0.6;   ///< weight of the unsharp mask (1.2 px)
  double vignetting = 0.18;  ///< loss of light in the corners

  ParameterList list();
  void validate() const;
};

/// What differs from scene to scene; drawn by the sensor, kept for the record.
struct ColorSettings {
  double exposure = 1.0;                      ///< factor on linear light
  double gain = 1.0;                          ///< analogue
  double white_balance[3] = {1.0, 1.0, 1.0};  ///< BGR
  double saturation = 1.0;
  double contrast = 0.0;
};

class ColorSensor {
 public:
  explicit ColorSensor(const ColorSensorParameters& parameters) : parameters_(parameters) { parameters_.validate(); }

  /// Automatic exposure and white balance for a linear CV_32FC3 BGR image, with the spread of real ones.
  ColorSettings settle(const cv::Mat& radiance, std::uint64_t seed) const;

  /// CV_8UC3 BGR photograph of a linear CV_32FC3 BGR image. Same seed, same bits, for any number of threads.
  cv::Mat expose(const cv::Mat& radiance, const ColorSettings& settings, std::uint64_t seed) const;

 private:
  ColorSensorParameters parameters_;
};

}  // namespace recognition
