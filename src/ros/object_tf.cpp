#include "ros/object_tf.h"

#include <ros/time.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bags/bag_file.h"
#include "ros/message_conversions.h"
#include "ros/frame_names.h"

namespace recognition {
namespace {

const std::vector<std::string> kTopics = {"/tf", "tf", "/tf_static", "tf_static"};
const ros::Duration kWholeBag(1e8), kWhileTraining(30.0);  // of tf that is kept
const ros::WallDuration kAgain(0.005);                     // between looks for tf that is late

std::string requiredName(const std::string& frame) {
  const std::string plain = plainFrame(frame);
  if (plain.empty()) throw std::invalid_argument("the tf frame '" + frame + "' has no name");
  return plain;
}

std::string framesIn(const tf2::BufferCore& buffer) {
  std::vector<std::string> names;
  buffer._getFrameStrings(names);
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += " " + name;
  return text;
}

int readTf(const std::string& file, tf2::BufferCore& buffer) {
  int transforms = 0;
  BagFile bag(file);
  for (const BagFile::Entry& entry : bag.entries()) {
    const std::string& topic = bag.connection(entry).topic;
    if (std::find(kTopics.begin(), kTopics.end(), topic) == kTopics.end()) continue;
    const auto message = bag.message<tf2_msgs::TFMessage>(entry);
    if (!message) continue;
    const bool is_static = topic.find("static") != std::string::npos;
    for (const auto& transform : message->transforms) transforms += buffer.setTransform(transform, file, is_static);
  }
  return transforms;
}

}  // namespace

ObjectTf::ObjectTf(const std::string& object_frame) : object_(requiredName(object_frame)) {}
ObjectTf::ObjectTf(ObjectTf&&) noexcept = default;
ObjectTf::~ObjectTf() = default;

ObjectTf ObjectTf::ofBag(const std::string& file, const std::string& object_frame) {
  ObjectTf tf(object_frame);
  tf.buffer_ = std::make_unique<tf2::BufferCore>(kWholeBag);
  const int transforms = readTf(file, *tf.buffer_);
  if (transforms == 0)
    throw std::runtime_error(file + ": holds no tf, so it does not tell where '" + tf.object_ + "' is");
  if (!tf.buffer_->_frameExists(tf.object_))
    throw std::runtime_error(file + ": its tf has no frame '" + tf.object_ + "'; there are" + framesIn(*tf.buffer_));
  return tf;
}

ObjectTf ObjectTf::live(const std::string& object_frame) {
  ObjectTf tf(object_frame);
  tf.buffer_ = std::make_unique<tf2::BufferCore>(kWhileTraining);
  tf.listener_ = std::make_unique<tf2_ros::TransformListener>(*tf.buffer_);
  return tf;
}

Pose ObjectTf::cameraFromObject(const std::string& camera_frame, std::int64_t stamp, double patience) const {
  const std::string camera = requiredName(camera_frame);
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp));
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(patience);
  while (!buffer_->canTransform(camera, object_, time) && ros::WallTime::now() < end) kAgain.sleep();
  try {
    return poseFromMessage(buffer_->lookupTransform(camera, object_, time).transform);
  } catch (const tf2::TransformException& error) {
    throw std::runtime_error("tf does not tell where '" + object_ + "' was in '" + camera + "' at " +
                             std::to_string(time.toSec()) + " s: " + error.what());
  }
}

}  // namespace recognition
