#pragma once

#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/features/feature_types.h"

namespace recognition {

/// SURF: Bay, Ess, Tuytelaars, Van Gool, "Speeded-Up Robust Features (SURF)", CVIU 110(3), 2008. Section numbers below
/// are of that article.
struct SurfParameters {
  /// Least determinant (eq. 3): gray levels squared, derivatives divided by the filter's area.
  double hessian_threshold = 5.0;
  int octaves = 4;
  int layers = 3;                 ///< scales an octave that can hold a keypoint; two more are computed (Sec. 3.3)
  int sampling_step = 1;          ///< pixels between samples of the first octave; doubles from octave to octave
  int double_below_width = 1600;  ///< images narrower than this are doubled first (Sec. 3.3); 0: never
  bool upright = false;           ///< U-SURF: no orientation (Sec. 4.1)
  bool overlap = true;            ///< sub-regions of 9 s that overlap (M-SURF) in place of 5 s side by side
};

/// SIFT through OpenCV 4.4 or later. The first octave is doubled there, always.
struct SiftParameters {
  int layers = 3;                    ///< an octave
  double contrast_threshold = 0.04;  ///< OpenCV's: divided by the layers
  double edge_threshold = 10.0;      ///< ratio of the principal curvatures
  double sigma = 1.6;                ///< pixels of the doubled image
  bool root = true;  ///< square roots of the L1-normalised descriptor (Arandjelovic and Zisserman, CVPR 2012)
};

/// How a keypoint gets its depth.
struct LiftingParameters {
  int max_hole = 3;          ///< depth pixels to the nearest pixel of the surface; farther: no depth
  double jump = 0.015;       ///< metres between neighbouring depths that part two surfaces (epsilon of Sec. IV)
  double foreground = 0.25;  ///< share of the weight under the keypoint from which the nearer of two surfaces owns it
};

/// Parameters of Sec. V's feature pipeline. Defaults are ours; config/paper.yaml holds the paper's.
struct FeatureParameters {
  DescriptorType descriptor = DescriptorType::kSurf64;
  bool use_regions = true;  ///< only inside the regions of interest (Sec. IV; the paper calls it optional)
  int region_margin = 4;    ///< depth pixels by which the regions grow, for features on outlines
  int max_features = 0;     ///< strongest kept; 0: all
  SurfParameters surf;
  SiftParameters sift;
  LiftingParameters lifting;

  ParameterList list();
  void validate() const;
};

}  // namespace recognition
