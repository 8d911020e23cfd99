#pragma once

#include <map>
#include <string>
#include <vector>

#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"
#include "ros/label_layout.h"

namespace recognition {

/// A rejection's name for people: too_little_seen -> too little seen.
std::string inWords(std::string name);

/// <prefix><object>_<instance>: the tf frame of a detection.
std::string frameName(const messages::Detection& detection, const std::string& prefix = "");
/// Sets `frame` of those that are accepted.
void nameFrames(const std::string& prefix, messages::DetectionArray* detections);

/// Brings detections, in poses, covariances and boxes, from their header's frame into `target`.
void changeFrame(const Pose& target_from_header, const std::string& target, messages::DetectionArray* detections);

/// Transforms from the header's frame to each detection's that has one.
tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections);

/// Draws detections for rviz: the model's cloud, the three-sigma ellipsoid of Sigma, and a label with the confidence.
/// What is drawn of a model is prepared once.
class MarkerMaker {
 public:
  /// Markers of all detections, beginning with one that removes the last frame's.
  visualization_msgs::MarkerArrayPtr make(const messages::DetectionArray& detections, const ModelDatabase& database,
                                          const LabelView& view);
  /// Markers of the rejected among `hypotheses`: ellipsoid and why, of each object the most confident one, a few in all.
  /// Duplicates of what was found, and what better ones explain, are left out; labels keep clear of those that make() gives the found ones.
  visualization_msgs::MarkerArrayPtr makeRejected(const messages::DetectionArray& hypotheses,
                                                  const ModelDatabase& database, const LabelView& view);

 private:
  struct Prepared {
    visualization_msgs::Marker cloud;      // object frame
    visualization_msgs::Marker ellipsoid;  // object frame
    OrientedBox box;
  };
  /// What is drawn of one object, and where.
  struct Placed {
    const Prepared* prepared = nullptr;  // null: unknown object
    Pose frame_from_object = Pose::Identity(), frame_from_ellipsoid = Pose::Identity();
    std::string label;
    LabelPlace label_place{Eigen::Vector3d::Zero(), 0.0};
    size_t number = 0;  // in the layout
  };
  /// All of known objects, with labels that keep clear of each other and of other objects.
  std::vector<Placed> place(const std::vector<const messages::Detection*>& detections,
                            const std::vector<std::string>& labels, double max_size, const ModelDatabase& database,
                            LabelLayout* layout);
  const Prepared& prepared(const ObjectModel& model, int object);

  std::map<const ObjectModel*, Prepared> prepared_;
};

}  // namespace recognition
