#pragma once

namespace rgbd_recognition {

/// SIFT through OpenCV 4.4 or later. The first octave is doubled there, always.
struct SiftParameters {
  int layers = 3;                    ///< an octave
  double contrast_threshold = 0.04;  ///< OpenCV's: divided by the layers
  double edge_threshold = 10.0;      ///< ratio of the principal curvatures
  double sigma = 1.6;                ///< pixels of the doubled image
  bool root = true;  ///< square roots of the L1-normalised descriptor (Arandjelovic and Zisserman, CVPR 2012)
};

}  // namespace rgbd_recognition
