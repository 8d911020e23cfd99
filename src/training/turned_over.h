#pragma once

#include <vector>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// Poses model_from_addition of an object that was turned over between two recordings: each stood on the other's top,
/// so that the planes they stood on leave only a turn about the vertical, and the middles of the clouds the place. One
/// for each `step` degrees of that turn; none where a plane is not known, or where the heights above them differ.
std::vector<Pose> turnedOverPoses(const ObjectModel& model, const ObjectModel& addition, double step);

/// Whether the planes on which the two stood face each other; both in one frame. True where one is not known.
bool isTurnedOver(const ObjectModel& model, const ObjectModel& added);

/// Whether the cloud shows what touches each plane. Without it, what is there was only estimated.
bool isWhole(const ObjectModel& model);

/// What touches the planes: for each plane the lowest points of the other cloud that face it, as pairs that shall
/// meet. `from` are the addition's or its plane's points in the model's frame, `to` where they should be.
struct Contact {
  Eigen::Vector3f from;
  SurfacePoint to;
};
std::vector<Contact> contactsOf(const ObjectModel& model, const ObjectModel& addition, const Pose& model_from_addition);

}  // namespace recognition
