#include "rgbd_recognition/tracking/tracking_parameters.h"

namespace recognition {

ParameterList TrackingParameters::list() {
  return {
      doubleParameter("sure_confidence", "", &sure_confidence, 0.0, 1.0,
                      "Confidence from which one detection begins a track"),
      intParameter("confirm_detections", "", &confirm_detections, 1, 100, "Detections that a less sure track needs"),
      doubleParameter("lost_after", "s", &lost_after, 0.0, 3600.0, "Time for which a track may contradict the frames"),
      doubleParameter("hidden_for", "s", &hidden_for, 0.0, 86400.0, "Time for which something may stand before it"),
      doubleParameter("unseen_for", "s", &unseen_for, 0.0, 86400.0, "Time without depth or in the dark"),
      doubleParameter("forget_after", "s", &forget_after, 0.0, 86400.0, "Time out of view"),
      doubleParameter("max_distance", "m", &max_distance, 0.0, 1.0, "Largest distance of a track from its detection"),
      doubleParameter("max_angle", "deg", &max_angle, 0.0, 180.0,
                      "Largest angle between them; beyond, both are tested"),
      doubleParameter("search_period", "s", &search_period, 0.0, 86400.0,
                      "Time after which the whole frame is searched again"),
      doubleParameter("clock_step", "s", &clock_step, 0.0, 3600.0,
                      "How much older than the last a frame's stamp may be before the clock counts as set back"),
  };
}

void TrackingParameters::validate() const {
  TrackingParameters copy = *this;
  validateParameters(copy.list(), "tracking");
}

}  // namespace recognition
