#pragma once

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/recorded_object.h"

namespace recognition {

/// How one model of an object lies in another's frame: found by their features (a type that both have), or, where too
/// few agree or their prints do badly, as that object on its head; refined on their clouds and by what they stood on.
struct ModelFit {
  Pose model_from_addition = Pose::Identity();
  int features = 0;           ///< pairs that agree on it; on its head, few may
  double correlation = 0.0;   ///< of their prints where they overlap
  double contradicted = 0.0;  ///< share of both clouds that lies where the other was seen to have nothing
  double residual = 0.0;      ///< median distance of the clouds where they overlap, metres
};

/// How the object stands in the views that extend a model.
enum class Stand {
  kAny,         ///< as before, or otherwise: found out, which objects whose sides look alike do not allow
  kTurnedOver,  ///< on its head
};

/// Throws std::runtime_error with the reason if the two do not fit: too few features agree (another object, or too
/// little overlap), or their surfaces lie apart.
ModelFit fitModels(const ObjectModel& model, const ObjectModel& addition, Stand stand = Stand::kAny);

/// The model with what `addition`, another model of the same object from other views, adds: it may have stood
/// differently, such as on its head. Keeps the model's frame, name and origin, and Sigma as long as no view shows what
/// it stood on. Throws as fitModels() does.
ObjectModel extendModel(const ObjectModel& model, const ObjectModel& addition, const RecordingParameters& parameters,
                        Stand stand = Stand::kAny);

}  // namespace recognition
