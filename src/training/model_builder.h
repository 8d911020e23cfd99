#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/training_parameters.h"
#include "rgbd_recognition/training/training_progress.h"

namespace recognition {

/// Sec. III from a textured mesh: renders views all around, extracts features of each of `types` in them, places them
/// on the surface where their pixel's ray meets it, merges those of the same surface point over views, samples the
/// coloured cloud, computes Sigma. Same mesh, same model, for any number of threads. Throws std::invalid_argument with
/// the reason if nothing can be seen. What `progress` throws ends it.
ObjectModel buildModelFromMesh(const TexturedMesh& mesh, const std::string& name, const TrainingParameters& training,
                               const FeatureParameters& features, const std::vector<DescriptorType>& types,
                               const TrainingProgress& progress = nullptr);

}  // namespace recognition
