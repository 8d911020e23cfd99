#include "ros/standard_outputs.h"

#include <boost/make_shared.hpp>

namespace recognition {

geometry_msgs::PoseArrayPtr posesOf(const messages::DetectionArray& detections) {
  const auto poses = boost::make_shared<geometry_msgs::PoseArray>();
  poses->header = detections.header;
  for (const messages::Detection& detection : detections.detections)
    if (detection.accepted) poses->poses.push_back(detection.pose.pose);
  return poses;
}

#ifdef RGBD_RECOGNITION_VISION_MSGS
namespace {

[[maybe_unused]] void setId(const messages::Detection& detection, const ModelDatabase&, std::string& id) {
  id = detection.object;
}

[[maybe_unused]] void setId(const messages::Detection& detection, const ModelDatabase& database, std::int64_t& id) {
  id = database.find(detection.object);
}

}  // namespace

vision_msgs::Detection3DArrayPtr detections3dOf(const messages::DetectionArray& detections,
                                                const ModelDatabase& database) {
  const auto array = boost::make_shared<vision_msgs::Detection3DArray>();
  array->header = detections.header;
  for (const messages::Detection& detection : detections.detections) {
    if (!detection.accepted) continue;
    vision_msgs::Detection3D one;
    one.header = detections.header;
    one.results.resize(1);
    setId(detection, database, one.results.front().id);
    one.results.front().score = detection.confidence;
    one.results.front().pose = detection.pose;
    one.bbox.center = detection.box;
    one.bbox.size = detection.size;
    array->detections.push_back(one);
  }
  return array;
}
#endif

void StandardOutputs::publish(const messages::DetectionArray& detections,
                              [[maybe_unused]] const ModelDatabase& database) const {
  if (poses_.getNumSubscribers() > 0) poses_.publish(posesOf(detections));
#ifdef RGBD_RECOGNITION_VISION_MSGS
  if (detections_3d_.getNumSubscribers() > 0) detections_3d_.publish(detections3dOf(detections, database));
#endif
}

}  // namespace recognition
