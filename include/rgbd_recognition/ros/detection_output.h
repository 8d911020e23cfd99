#pragma once

#include <map>
#include <string>

#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/ros/messages.h"

namespace rgbd_recognition {

/// <object>_<instance>: the tf frame of a detection.
std::string frameName(const messages::Detection& detection);

/// Brings detections, in poses and covariances, from their header's frame into `target`.
void changeFrame(const Pose& target_from_header, const std::string& target, messages::DetectionArray* detections);

/// Transforms from the header's frame to each accepted detection's.
tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections);

/// Draws detections for rviz: the model's cloud, the three-sigma ellipsoid of Sigma, and a label with the confidence.
/// What is drawn of a model is prepared once.
class MarkerMaker {
 public:
  /// Markers of all detections, beginning with one that removes the last frame's. `up`: where labels go, a unit vector
  /// in the detections' frame.
  visualization_msgs::MarkerArrayPtr make(const messages::DetectionArray& detections, const ModelDatabase& database,
                                          const Eigen::Vector3d& up);
  /// Markers of the rejected among `hypotheses`: ellipsoid and why, of the most confident few.
  visualization_msgs::MarkerArrayPtr makeRejected(const messages::DetectionArray& hypotheses,
                                                  const ModelDatabase& database, const Eigen::Vector3d& up);

 private:
  struct Prepared {
    visualization_msgs::Marker cloud;      // object frame
    visualization_msgs::Marker ellipsoid;  // object frame
    double height = 0.0;                   // of the label over the object's origin, metres
  };
  /// Places what is drawn of one object, with one id and the label above it, `up` times its height; nothing for an
  /// unknown one.
  void add(const messages::Detection& detection, const std::string& label, bool accepted, const Eigen::Vector3d& up,
           const ModelDatabase& database, visualization_msgs::MarkerArray* array);
  const Prepared& prepared(const ObjectModel& model, int object);

  std::map<const ObjectModel*, Prepared> prepared_;
};

}  // namespace rgbd_recognition
