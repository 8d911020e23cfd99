#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>

namespace recognition {

/// A nodelet that subscribes to its inputs only while somebody listens to one of its outputs (or always, with `~lazy`
/// false), and only while it is enabled. Unlike nodelet_topic_tools::NodeletLazy, image_transport outputs count too.
class LazyNodelet : public nodelet::Nodelet {
 protected:
  template <typename Message>
  ros::Publisher advertiseLazy(ros::NodeHandle& node, const std::string& topic) {
    const auto changed = [this](const ros::SingleSubscriberPublisher&) { updateListening(); };
    const std::lock_guard<std::mutex> lock(listening_mutex_);
    const ros::Publisher publisher = node.advertise<Message>(topic, 1, changed, changed);
    listeners_.push_back([publisher] { return publisher.getNumSubscribers(); });
    return publisher;
  }

  image_transport::Publisher advertiseLazyImage(ros::NodeHandle& node, const std::string& topic);

  /// Call once all outputs are advertised.
  void startListening(bool lazy);
  /// Disabled, the inputs stay off, whoever listens.
  void enable(bool enabled);

  /// Called in turn, beginning with startInputs().
  virtual void startInputs() = 0;
  virtual void stopInputs() = 0;

  bool listening() const { return listening_; }
  bool enabled() const { return enabled_; }

 private:
  void updateListening();

  std::mutex listening_mutex_;  // guards all below: connections come and go while onInit still runs
  std::vector<std::function<std::uint32_t()>> listeners_;
  bool started_ = false;
  bool lazy_ = true;
  std::atomic<bool> enabled_{true};
  std::atomic<bool> listening_{false};
};

}  // namespace recognition
