#include "rgbd_recognition/tracking/tracking_parameters.h"

namespace recognition {

ParameterList TrackingParameters::list() {
  return {
      intParameter("confirm_frames", "", &confirm_frames, 1, 100, "detections before a track counts as found"),
      doubleParameter("lost_after", "s", &lost_after, 0.0, 3600.0, "time in view without a detection until it is lost"),
      doubleParameter("forget_after", "s", &forget_after, 0.0, 86400.0, "time out of view until it is lost"),
      doubleParameter("max_distance", "m", &max_distance, 0.0, 1.0,
                      "largest distance between a track and its detection"),
      doubleParameter("max_angle", "deg", &max_angle, 0.0, 180.0,
                      "largest angle between them; beyond, the detection contradicts the track's pose"),
      doubleParameter("drift_translation", "m", &drift_translation, 0.0, 1.0,
                      "how far an object at rest may drift in a second"),
      doubleParameter("drift_rotation", "deg", &drift_rotation, 0.0, 180.0, "how far it may turn in a second"),
      doubleParameter("least_translation", "m", &least_translation, 1e-5, 1.0,
                      "standard deviation that a detection has at least"),
      doubleParameter("least_rotation", "deg", &least_rotation, 1e-3, 180.0,
                      "standard deviation of its rotation, at least"),
      doubleParameter("view_width", "deg", &view_width, 1.0, 179.0, "the camera's horizontal field of view"),
      doubleParameter("view_height", "deg", &view_height, 1.0, 179.0, "the camera's vertical field of view"),
  };
}

void TrackingParameters::validate() const {
  TrackingParameters copy = *this;
  validateParameters(copy.list(), "tracking");
}

}  // namespace recognition
