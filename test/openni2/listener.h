#pragma once

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace recognition::openni2 {

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

}  // namespace recognition::openni2
