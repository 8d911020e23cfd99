#pragma once

#include <map>
#include <string>
#include <vector>

#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/ros/messages.h"

namespace recognition {

/// <object>_<instance>: the tf frame of a detection.
std::string frameName(const messages::Detection& detection);

/// Brings detections, in poses and covariances, from their header's frame into `target`.
void changeFrame(const Pose& target_from_header, const std::string& target, messages::DetectionArray* detections);

/// Transforms from the header's frame to each detection's, accepted or not.
tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections);

/// How labels are placed so that they can be read: unit vectors in the detections' frame.
struct LabelView {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  ///< the viewer; zero where he may be anywhere

  static LabelView ofCamera() { return {-Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ()}; }
};

/// Keeps labels from covering each other.
class LabelLayout {
 public:
  explicit LabelLayout(const LabelView& view) : view_(view) {}

  /// Where a text of that size (metres) goes that is wanted at `center`: there, or above those that are in its way.
  Eigen::Vector3d place(Eigen::Vector3d center, const std::string& text, double size);

 private:
  struct Label {
    Eigen::Vector3d center;
    double width, height;
  };
  bool cover(const Label& a, const Label& b) const;

  LabelView view_;
  std::vector<Label> placed_;
};

/// Draws detections for rviz: the model's cloud, the three-sigma ellipsoid of Sigma, and a label with the confidence.
/// What is drawn of a model is prepared once.
class MarkerMaker {
 public:
  /// Markers of all detections, beginning with one that removes the last frame's.
  visualization_msgs::MarkerArrayPtr make(const messages::DetectionArray& detections, const ModelDatabase& database,
                                          const LabelView& view);
  /// Markers of the rejected among `hypotheses`: ellipsoid and why, of the most confident few. Duplicates of what was
  /// found are left out; labels keep clear of those that make() gives the found ones.
  visualization_msgs::MarkerArrayPtr makeRejected(const messages::DetectionArray& hypotheses,
                                                  const ModelDatabase& database, const LabelView& view);

 private:
  struct Prepared {
    visualization_msgs::Marker cloud;      // object frame
    visualization_msgs::Marker ellipsoid;  // object frame
    double height = 0.0;                   // of the label over the ellipsoid's centre, metres
  };
  /// What is drawn of one object, and where.
  struct Placed {
    const Prepared* prepared = nullptr;  // null: unknown object
    Pose frame_from_object = Pose::Identity(), frame_from_ellipsoid = Pose::Identity();
    std::string label;
    Eigen::Vector3d label_center = Eigen::Vector3d::Zero();
  };
  Placed place(const messages::Detection& detection, const std::string& label, double size, const LabelView& view,
               const ModelDatabase& database, LabelLayout* layout);
  const Prepared& prepared(const ObjectModel& model, int object);

  std::map<const ObjectModel*, Prepared> prepared_;
};

}  // namespace recognition
