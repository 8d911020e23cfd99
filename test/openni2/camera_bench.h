#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace rgbd_recognition::openni2 {

constexpr double kPatience = 20.0;  // s: only something broken takes that long

/// Keeps the messages of a topic, and waits for those one wants.
template <typename Message>
class Listener {
 public:
  using Pointer = boost::shared_ptr<const Message>;

  explicit Listener(const std::string& topic)
      : subscriber_(ros::NodeHandle().subscribe(topic, 10, &Listener::receive, this)) {}

  /// The next message that comes from now on for which `wanted` holds; null when none does.
  Pointer next(const std::function<bool(const Message&)>& wanted = [](const Message&) { return true; }) {
    std::unique_lock<std::mutex> lock(mutex_);
    const size_t first = messages_.size();
    size_t looked_at = first;
    Pointer found;
    arrived_.wait_for(lock, std::chrono::duration<double>(kPatience), [&] {
      for (; looked_at < messages_.size() && !found; ++looked_at) {
        if (wanted(*messages_[looked_at])) found = messages_[looked_at];
      }
      return static_cast<bool>(found);
    });
    return found;
  }

  /// The next `count` messages; fewer when they do not come.
  std::vector<Pointer> nextOf(size_t count) {
    std::unique_lock<std::mutex> lock(mutex_);
    const size_t first = messages_.size();
    arrived_.wait_for(lock, std::chrono::duration<double>(kPatience),
                      [&] { return messages_.size() >= first + count; });
    return std::vector<Pointer>(messages_.begin() + first, messages_.end());
  }

  /// Whether a message for which `wanted` holds was there already or comes.
  bool any(const std::function<bool(const Message&)>& wanted) {
    for (const Pointer& message : all()) {
      if (wanted(*message)) return true;
    }
    return next(wanted) != nullptr;
  }

  std::vector<Pointer> all() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }

  size_t count() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }

 private:
  void receive(const Pointer& message) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      messages_.push_back(message);
    }
    arrived_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<Pointer> messages_;
  ros::Subscriber subscriber_;
};

using ImageListener = Listener<sensor_msgs::Image>;
using InfoListener = Listener<sensor_msgs::CameraInfo>;

/// A camera nodelet in a namespace of its own, in this process.
class Camera {
 public:
  /// `parameters` are the nodelet's private ones.
  Camera(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& parameters);
  ~Camera();

  bool loaded() const { return loaded_; }
  std::string topic(const std::string& relative) const { return "/" + name_ + "/" + relative; }

  /// Sets one parameter by dynamic reconfigure; returns the value that the nodelet took.
  std::string reconfigure(const std::string& parameter, const char* value);
  bool reconfigure(const std::string& parameter, bool value);

  /// Waits until the camera's diagnostics satisfy `wanted`, given the level, the message, and all values by name.
  using Values = std::map<std::string, std::string>;
  bool reports(const std::function<bool(int level, const std::string& message, const Values& values)>& wanted);

 private:
  const std::string name_;
  Listener<diagnostic_msgs::DiagnosticArray> diagnostics_;
  nodelet::Loader loader_;
  bool loaded_ = false;
};

}  // namespace rgbd_recognition::openni2
