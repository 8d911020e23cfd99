#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// Modes of Table II by their names, then two for study that the paper advises against or leaves out of the table (LSL
/// + MR, LSQ + MR).
enum class SegmentationMode { kSimpleLinear, kSimpleQuadratic, kLsAicc, kLsMixed, kLsLinear, kLsQuadratic };

/// What the scan-lines' polynomials describe, and with it how the thresholds follow the range.
///
/// kConstant: depth z as in the paper, with the same epsilon and sigma at any range. kSensor: inverse depth 1/z (a
/// deviation from the paper). A triangulating sensor measures disparity, which is linear in 1/z: there its noise is the
/// same at any range (core/depth_noise.h), a plane is an exactly linear function of the pixel, and a threshold of t
/// metres at 1 m range becomes t z^2 at range z.
enum class NoiseModel { kConstant, kSensor };

/// Which components are too large for the trained objects. Sec. IV-A compares their PCA with the limits of all three
/// sizes, yet a component is a facet of an object: its smallest extent is near 0.
enum class SizeFilter {
  kLength,    ///< three-sigma length beyond the largest sigma_max (ours)
  kEllipsoid  ///< that, or diameter of gyration beyond the largest sigma_d, eq. (4): the paper's
};

/// Parameters of Sec. IV. Lengths marked "at 1 m" grow with the square of the range under NoiseModel::kSensor and are
/// constant under kConstant. Defaults are ours; config/paper.yaml holds the paper's.
struct SegmentationParameters {
  // Algorithm 1
  SegmentationMode mode = SegmentationMode::kLsMixed;
  NoiseModel noise_model = NoiseModel::kSensor;
  double epsilon = 0.008;  ///< metres at 1 m
  double sigma = 0.004;    ///< metres at 1 m
  double jump = 0.03;      ///< metres at 1 m
  double lateral = 0.8;    ///< pixels
  int lambda_min = 4;      ///< pixels
  int f_mixed = 12;        ///< LS-Mixed switches below lambda_min * f_mixed pixels

  int crease_support = 3;      ///< pixels
  double crease_angle = 12.0;  ///< degrees

  // Sec. IV-A
  int erosion = 5;                 ///< pixels
  int dilation = 3;                ///< pixels
  int plane_seed_distance = 8;     ///< pixels
  double plane_bound = 3.5;        ///< standard deviations of the sensor
  double plane_size_margin = 1.4;  ///< times sigma_max
  double hidden_plane = 0.5;       ///< ours: times that, of planes in components larger than any object
  SizeFilter size_filter = SizeFilter::kLength;
  double min_size_margin = 0.5;  ///< times sigma_min
  double max_size_margin = 1.4;  ///< times sigma_max, and sigma_d under SizeFilter::kEllipsoid
  int min_pixels = 40;
  double expansion_bound = 4.0;  ///< standard deviations of the sensor
  int expansion_range = 8;       ///< pixels

  ParameterList list();
  /// Throws std::invalid_argument that names field, value and range.
  void validate() const;
};

}  // namespace recognition
