#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/training/feature_merging.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/training_progress.h"

namespace recognition {

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

/// Sec. III from a textured mesh: renders views all around, extracts features of each of `types` in them, places them
/// on the surface where their pixel's ray meets it, merges those of the same surface point over views, samples the
/// coloured cloud, computes Sigma. Same mesh, same model, for any number of threads. Throws std::invalid_argument with
/// the reason if nothing can be seen. What `progress` throws ends it.
ObjectModel buildModelFromMesh(const TexturedMesh& mesh, const std::string& name, const TrainingParameters& training,
                               const FeatureParameters& features, const std::vector<DescriptorType>& types,
                               const TrainingProgress& progress = nullptr);

}  // namespace recognition
