#pragma once

#include <functional>
#include <string>

#include "rgbd_recognition/core/parameters.h"
#include "rgbd_recognition/features/feature_extractor.h"
#include "rgbd_recognition/model/mesh.h"
#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// How models are trained from meshes (and, later, from recordings).
struct TrainingParameters {
  int views = 40;                   ///< camera directions around the object
  double point_spacing = 0.003;     ///< of the cloud P, metres

  ParameterList list();
  void validate() const;
};

/// Sec. III from a textured mesh: renders views all around, extracts features of each of `types` in them and lifts them to 3D, merges those of the
/// same surface point over views, samples the coloured cloud, computes Sigma. Throws std::invalid_argument with the reason if nothing can be seen.
ObjectModel buildModelFromMesh(const TexturedMesh& mesh, const std::string& name, const TrainingParameters& training,
                               const FeatureParameters& features, const std::vector<DescriptorType>& types);

}  // namespace rgbd_recognition
