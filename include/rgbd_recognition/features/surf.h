#pragma once

namespace rgbd_recognition {

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

}  // namespace rgbd_recognition
