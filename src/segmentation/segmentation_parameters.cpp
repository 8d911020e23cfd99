#include "rgbd_recognition/segmentation/segmentation_parameters.h"

namespace recognition {

ParameterList SegmentationParameters::list() {
  return {
      choiceParameter("mode", &mode,
                      {"simple_linear", "simple_quadratic", "ls_aicc", "ls_mixed", "ls_linear", "ls_quadratic"},
                      "fit and split of Algorithm 1, by the names of Table II"),
      choiceParameter(
          "noise_model", &noise_model, {"constant", "sensor"},
          "constant: depth with the same thresholds at any range (the paper); sensor: inverse depth, thresholds "
          "grow with range squared"),
      doubleParameter("epsilon", "m", &epsilon, 1e-5, 1.0,
                      "largest residual of a smooth run (MR splitting); at 1 m range for the sensor noise model"),
      doubleParameter("sigma", "m", &sigma, 1e-5, 1.0,
                      "standard deviation in AICc, eq. 6; at 1 m range for the sensor noise model"),
      doubleParameter(
          "jump", "m", &jump, 1e-4, 10.0,
          "neighbours farther apart separate runs, and no patch grows across; at 1 m range for the sensor noise "
          "model"),
      doubleParameter("lateral", "px", &lateral, 0.0, 10.0,
                      "lateral noise: times the slope it adds to epsilon and sigma on slanted surfaces (the paper: 0)"),
      intParameter("lambda_min", "px", &lambda_min, 3, 1000, "shortest run that may be split"),
      intParameter("f_mixed", "", &f_mixed, 1, 1000, "LS-Mixed uses AICc on runs shorter than lambda_min * f_mixed"),
      intParameter("crease_support", "px", &crease_support, 1, 25,
                   "edge points in the 5 x 5 pixels around a crease below which it is taken for noise (the paper: 1)"),
      doubleParameter("crease_angle", "deg", &crease_angle, 0.0, 89.0,
                      "smallest change of direction at a crease along a scan-line (the paper: 0)"),
      intParameter("erosion", "px", &erosion, 1, 31, "kernel that erodes the smooth pixels (1: none)"),
      intParameter("dilation", "px", &dilation, 1, 31, "kernel that dilates them again (1: none)"),
      intParameter("plane_seed_distance", "px", &plane_seed_distance, 1, 200,
                   "least distance from edges of a seed of a large plane"),
      doubleParameter("plane_bound", "", &plane_bound, 0.1, 100.0,
                      "largest distance from a large plane, in standard deviations of the sensor"),
      doubleParameter("hidden_plane", "", &hidden_plane, 0.0, 1.0,
                      "in a component larger than any object, planes of this share of a large plane's length are "
                      "removed and the rest kept; 0 drops it whole, as the paper does"),
      doubleParameter("plane_size_margin", "", &plane_size_margin, 0.1, 100.0,
                      "a plane is removed if its three-sigma length exceeds the largest sigma_max times this"),
      choiceParameter("size_filter", &size_filter, {"length", "ellipsoid"},
                      "length: a patch is too large by its three-sigma length; ellipsoid: or by its diameter of "
                      "gyration sigma_d, as the paper has it"),
      doubleParameter("min_size_margin", "", &min_size_margin, 0.0, 100.0,
                      "a patch is removed if its three-sigma length is below the smallest sigma_min times this"),
      doubleParameter("max_size_margin", "", &max_size_margin, 0.1, 100.0,
                      "a patch is removed if its three-sigma length exceeds the largest sigma_max times this; sigma_d "
                      "likewise"),
      intParameter("min_pixels", "px", &min_pixels, 1, 100000, "a patch with fewer pixels is removed"),
      doubleParameter(
          "expansion_bound", "", &expansion_bound, 0.0, 100.0,
          "distance from a patch's quadric up to which a neighbour joins it, in standard deviations of the sensor"),
      intParameter("expansion_range", "px", &expansion_range, 0, 100, "farthest that a patch grows (0: no expansion)"),
  };
}

void SegmentationParameters::validate() const {
  SegmentationParameters copy = *this;
  validateParameters(copy.list(), "segmentation");
}

}  // namespace recognition
