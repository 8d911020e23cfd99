#include "camera/openni2_frames.h"

#include <geometry_msgs/TransformStamped.h>
#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <mutex>

namespace recognition {
namespace {

// metres along the left of camera_link
constexpr double kDepthCamera = -0.02;
constexpr double kColorCamera = -0.045;

geometry_msgs::TransformStamped transform(const std::string& parent, const std::string& child, double left,
                                          bool to_optical) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.header.stamp = ros::Time::now();
  transform.child_frame_id = child;
  transform.transform.translation.y = left;
  if (to_optical) {  // roll and yaw of -90 degrees: x right, y down, z forward
    transform.transform.rotation.x = -0.5;
    transform.transform.rotation.y = 0.5;
    transform.transform.rotation.z = -0.5;
    transform.transform.rotation.w = 0.5;
  } else {
    transform.transform.rotation.w = 1.0;
  }
  return transform;
}

}  // namespace

struct StaticFrames::State {
  std::mutex mutex;  // protects the message
  ros::NodeHandle node;
  ros::Publisher publisher;
  tf2_msgs::TFMessage message;

  void set(const geometry_msgs::TransformStamped& transform) {
    auto& all = message.transforms;
    const auto is_it = [&](const auto& other) { return other.child_frame_id == transform.child_frame_id; };
    all.erase(std::remove_if(all.begin(), all.end(), is_it), all.end());
    all.push_back(transform);
  }
};

std::shared_ptr<StaticFrames> StaticFrames::shared() {
  static std::mutex mutex;
  static std::weak_ptr<StaticFrames> existing;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<StaticFrames> frames = existing.lock();
  if (!frames) {
    frames.reset(new StaticFrames);
    existing = frames;
  }
  return frames;
}

StaticFrames::StaticFrames() : state_(std::make_unique<State>()) {
  state_->publisher = state_->node.advertise<tf2_msgs::TFMessage>("/tf_static", 10, true);
}

StaticFrames::~StaticFrames() = default;

void StaticFrames::addKinect(const std::string& camera) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->set(transform(camera + "_link", camera + "_depth_frame", kDepthCamera, false));
  state_->set(transform(camera + "_link", camera + "_rgb_frame", kColorCamera, false));
  state_->set(transform(camera + "_depth_frame", camera + "_depth_optical_frame", 0.0, true));
  state_->set(transform(camera + "_rgb_frame", camera + "_rgb_optical_frame", 0.0, true));
  state_->publisher.publish(state_->message);
}

}  // namespace recognition
