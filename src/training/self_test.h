#pragma once

#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/training/object_trainer.h"
#include "rgbd_recognition/training/training_progress.h"

namespace recognition {

/// Looks for a mesh's new model, the only one in the database, in a few rendered frames; see SelfTest. Same mesh, same
/// model, same answer. `features`: of the extractors; a type that the model has is taken.
SelfTest testModel(const TexturedMesh& mesh, const ObjectModel& model, FeatureParameters features,
                   const TrainingProgress& progress);

}  // namespace recognition
