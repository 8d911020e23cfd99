// A nodelet that hears what recognition finds. In recognition's manager the message is shared, not copied:
//   rosrun nodelet nodelet load rgbd_recognition_examples/detection_listener /recognition/manager
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <rgbd_recognition/DetectionArray.h>
#include <ros/ros.h>

namespace rgbd_recognition_examples {

class DetectionListener : public nodelet::Nodelet {
  void onInit() override {
    subscriber_ = getNodeHandle().subscribe("/recognition/detections", 1, &DetectionListener::hear, this);
  }

  void hear(const rgbd_recognition::DetectionArrayConstPtr& heard) {
    for (const auto& detection : heard->detections) {
      const auto& p = detection.pose.pose.position;
      NODELET_INFO("%s at %.3f %.3f %.3f m in %s, confidence %.2f", detection.object.c_str(), p.x, p.y, p.z,
                   heard->header.frame_id.c_str(), detection.confidence);
    }
  }

  ros::Subscriber subscriber_;
};

}  // namespace rgbd_recognition_examples

PLUGINLIB_EXPORT_CLASS(rgbd_recognition_examples::DetectionListener, nodelet::Nodelet)
