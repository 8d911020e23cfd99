#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// When features of two training views are one feature of the object.
struct MergingParameters {
  double distance = 0.0025;  ///< largest, between their places on the surface, metres
  double size_share = 0.08;  ///< of a feature's size, added to `distance`: large features are placed less exactly
  double size_ratio = 1.4;   ///< largest, between their sizes
  double descriptor_distance = 0.45;  ///< largest, of unit-length descriptors
  int max_features = 6000;            ///< kept an object and type: those seen in most views

  ParameterList list();
  void validate() const;
};

/// How models are trained from meshes.
struct TrainingParameters {
  int views = 64;  ///< camera directions around the object
  double near_distance =
      0.6;  ///< of the nearest camera from the object's centre, metres; more for objects that would not fit into view
  double far_distance = 1.8;  ///< of the farthest
  int distances = 3;          ///< in geometric steps from near to far
  double focal_length =
      1050.0;         ///< of the training camera, pixels: with the distances, the detail at which features are learnt
  double blur = 0.6;  ///< Gaussian sigma in pixels of the training images: what a lens and a Bayer pattern leave
  double largest_slant = 70.0;   ///< between a feature's surface normal and the view, degrees
  double outline_margin = 0.25;  ///< least distance of a feature from the outline, as a share of its size
  double point_spacing = 0.003;  ///< of the cloud P, metres
  int max_points = 30000;        ///< of the cloud P; the spacing grows for large objects
  MergingParameters merging;

  ParameterList list();
  void validate() const;
};

}  // namespace recognition
