#pragma once

namespace rgbd_recognition {

/// SURF: Bay, Ess, Tuytelaars, Van Gool, "Speeded-Up Robust Features (SURF)", CVIU 110(3), 2008. Section numbers below
/// are of that article.
struct SurfParameters {
  double hessian_threshold =
      3.0;  ///< least determinant (eq. 3), gray levels squared, derivatives divided by the filter's area
  int octaves = 4;
  int layers = 2;                 ///< scales an octave that can hold a keypoint; two more are computed (Sec. 3.3)
  int sampling_step = 1;          ///< pixels between samples of the first octave; doubles from octave to octave
  int double_below_width = 1000;  ///< images narrower than this are doubled first (Sec. 3.3); 0: never
  bool upright = false;           ///< U-SURF: no orientation (Sec. 4.1)
  bool root = false;              ///< signed square roots of the L1-normalised descriptor; still of unit length
};

}  // namespace rgbd_recognition
