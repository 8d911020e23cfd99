#pragma once

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/recorded_object.h"

namespace recognition {

/// How one model of an object lies in another's frame. Features of a type that both have place it. Where too few agree,
/// or the textures then disagree, the object is tried on its head. Clouds and rest planes refine the pose.
struct ModelFit {
  Pose model_from_addition = Pose::Identity();
  int features = 0;           ///< pairs that agree on it; may be few on its head
  double correlation = 0.0;   ///< of their textures where they overlap
  double contradicted = 0.0;  ///< share of both clouds that lies where the other was seen to have nothing
  double residual = 0.0;      ///< median distance of the clouds where they overlap, metres
};

/// How the object stands in the views that extend a model.
enum class Stand {
  kAny,         ///< unknown: found from the views, which fails for objects with similar sides
  kTurnedOver,  ///< on its head
};

/// Throws std::runtime_error with the reason if the two do not fit: too few features agree (another object, or too
/// little overlap), or their surfaces lie apart.
ModelFit fitModels(const ObjectModel& model, const ObjectModel& addition, Stand stand = Stand::kAny);

/// The model with what `addition` adds, another model of the same object from other views. The object may have stood
/// differently, e.g. on its head. The result keeps the model's frame, name and origin, and its Sigma as long as no view
/// shows the side that it stood on. Throws as fitModels() does.
ObjectModel extendModel(const ObjectModel& model, const ObjectModel& addition, const RecordingParameters& parameters,
                        Stand stand = Stand::kAny);

}  // namespace recognition
