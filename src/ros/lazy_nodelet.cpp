#include "ros/lazy_nodelet.h"

#include <algorithm>

namespace recognition {

image_transport::Publisher LazyNodelet::advertiseLazyImage(ros::NodeHandle& node, const std::string& topic) {
  const auto changed = [this](const image_transport::SingleSubscriberPublisher&) { updateListening(); };
  const std::lock_guard<std::mutex> lock(listening_mutex_);
  const image_transport::Publisher publisher =
      image_transport::ImageTransport(node).advertise(topic, 1, changed, changed);
  listeners_.push_back([publisher] { return publisher.getNumSubscribers(); });
  return publisher;
}

void LazyNodelet::startListening(bool lazy) {
  {
    const std::lock_guard<std::mutex> lock(listening_mutex_);
    started_ = true;
    lazy_ = lazy;
  }
  updateListening();
}

void LazyNodelet::enable(bool enabled) {
  enabled_ = enabled;
  updateListening();
}

void LazyNodelet::updateListening() {
  const std::lock_guard<std::mutex> lock(listening_mutex_);
  if (!started_) return;
  const bool heard = std::any_of(listeners_.begin(), listeners_.end(), [](const auto& count) { return count() > 0; });
  const bool wanted = enabled_ && (heard || !lazy_);
  if (wanted == listening_) return;
  listening_ = wanted;
  wanted ? startInputs() : stopInputs();
}

}  // namespace recognition
