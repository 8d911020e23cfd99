#pragma once

#include <geometry_msgs/PoseArray.h>
#include <ros/publisher.h>
#ifdef RGBD_RECOGNITION_VISION_MSGS
#include <vision_msgs/Detection3DArray.h>
#endif

#include "rgbd_recognition/model/object_model.h"
#include "ros/messages.h"

namespace recognition {

/// The detections' poses, for programs that know no message of ours.
geometry_msgs::PoseArrayPtr posesOf(const messages::DetectionArray& detections);

#ifdef RGBD_RECOGNITION_VISION_MSGS
/// Boxes, poses and confidences. An object's id is its name; where ids are numbers (ROS 1), its place in `database`,
/// which is in the order of names.
vision_msgs::Detection3DArrayPtr detections3dOf(const messages::DetectionArray& detections,
                                                const ModelDatabase& database);
#endif

/// Publishes detections in other packages' messages: `poses`, and `detections_3d` where vision_msgs was there at build
/// time.
class StandardOutputs {
 public:
  /// `advertise` makes a publisher of each topic (a nodelet's lazy ones).
  template <typename Advertiser>
  void advertise(const Advertiser& advertiser) {
    poses_ = advertiser(geometry_msgs::PoseArray(), "poses");
#ifdef RGBD_RECOGNITION_VISION_MSGS
    detections_3d_ = advertiser(vision_msgs::Detection3DArray(), "detections_3d");
#endif
  }

  void publish(const messages::DetectionArray& detections, const ModelDatabase& database) const;

 private:
  ros::Publisher poses_, detections_3d_;
};

}  // namespace recognition
