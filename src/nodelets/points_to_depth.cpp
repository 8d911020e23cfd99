#include <pluginlib/class_list_macros.hpp>

#include "ros/image_conversions.h"
#include "ros/stage_nodelet.h"

namespace recognition {

/// Depth image from an organised cloud, so that all others see images only. Subscribes to `points`, publishes `~depth`.
class PointsToDepthNodelet : public StageNodelet {
 private:
  void configure() override {}
  void advertise() override { depth_ = advertiseLazy<sensor_msgs::Image>(getPrivateNodeHandle(), "depth"); }

  void startInputs() override {
    points_ = getNodeHandle().subscribe("points", 1, &PointsToDepthNodelet::convert, this);
  }
  void stopInputs() override { points_.shutdown(); }

  void convert(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    const Stopwatch watch;
    try {
      depth_.publish(depthFromPoints(*cloud));
      processed(cloud->header, watch.seconds());
    } catch (const std::exception& error) {
      reject(points_.getTopic(), error.what());
    }
  }

  ros::Publisher depth_;
  ros::Subscriber points_;
};

}  // namespace recognition

PLUGINLIB_EXPORT_CLASS(recognition::PointsToDepthNodelet, nodelet::Nodelet)
