#include "ros/training_session.h"

#include <algorithm>

namespace recognition {

TrainingSession::TrainingSession(const std::string& object, const RecordingParameters& parameters,
                                 TrainingOutputs& outputs, const std::function<bool()>& cancelled,
                                 const Listener& listener)
    : parameters_(parameters), outputs_(outputs), cancelled_(cancelled), listener_(listener) {
  message_.object = object;
  outputs_.clear(header());
}

void TrainingSession::progress(const std::string& stage, double done) {
  tell(stage, done, "");
  if (cancelled_()) throw TrainingCancelled();
}

void TrainingSession::viewTaken(const RecordedObject& object, const RecordedView& view, const std::string& reason) {
  ++(reason.empty() ? message_.views_used : message_.views_refused);
  const std::string text = std::to_string(message_.views_used) + " views" + (reason.empty() ? "" : ": " + reason);
  outputs_.showView({view.frame, object.lastPose(), view.mask}, parameters_, header(), text);
  outputs_.showObject(object, header());
  message_.coverage = static_cast<float>(object.coverage());
  tell("views", done_(message_.views_used), text);
  if (cancelled_()) throw TrainingCancelled();
}

void TrainingSession::tell(const std::string& stage, double done, const std::string& text) {
  message_.header = header();
  message_.stage = stage;
  message_.fraction = static_cast<float>(std::min(1.0, done));
  message_.message = text;
  outputs_.showProgress(message_);
  if (listener_) listener_(message_);
}

std_msgs::Header TrainingSession::header() const {
  std_msgs::Header header = header_;
  if (header.stamp.isZero()) header.stamp = ros::Time::now();
  return header;
}

}  // namespace recognition
