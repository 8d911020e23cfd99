#pragma once

#include <map>
#include <string>

#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "rgbd_recognition/ros/messages.h"
#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// <object>_<instance>: the tf frame of a detection.
std::string frameName(const messages::Detection& detection);

/// Transforms from the camera's frame to each accepted detection's.
tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections);

/// Draws detections for rviz: the model's cloud, the three-sigma ellipsoid of Sigma, and a label with the confidence.
/// What is drawn of a model is prepared once.
class MarkerMaker {
 public:
  /// Markers of all detections, beginning with one that removes the last frame's.
  visualization_msgs::MarkerArrayPtr make(const messages::DetectionArray& detections, const ModelDatabase& database);

 private:
  struct Prepared {
    visualization_msgs::Marker cloud;      // object frame
    visualization_msgs::Marker ellipsoid;  // object frame
    double height = 0.0;                   // of the label over the object's origin, metres
  };
  const Prepared& prepared(const ObjectModel& model, int object);

  std::map<const ObjectModel*, Prepared> prepared_;
};

}  // namespace rgbd_recognition
