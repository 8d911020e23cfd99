#pragma once

#include <functional>
#include <string>

#include "ros/training_outputs.h"

namespace recognition {

/// A training at work, as seen by whoever watches. Once `cancelled` holds, its callbacks throw TrainingCancelled.
class TrainingSession : public TrainingListener {
 public:
  /// Told all that the topic ~progress says.
  using Listener = std::function<void(const messages::TrainingProgress&)>;

  TrainingSession(const std::string& object, const RecordingParameters& parameters, TrainingOutputs& outputs,
                  const std::function<bool()>& cancelled, const Listener& listener);

  void progress(const std::string& stage, double done) override;
  void viewTaken(const RecordedObject& object, const RecordedView& view, const std::string& reason) override;
  void tell(const std::string& stage, double done, const std::string& text);

  std_msgs::Header header() const;
  /// Of the frame that is taken next.
  void setHeader(const std_msgs::Header& header) { header_ = header; }
  void setShare(const std::function<double(std::uint32_t used)>& done) { done_ = done; }
  std::uint32_t used() const { return message_.views_used; }

 private:
  const RecordingParameters& parameters_;
  TrainingOutputs& outputs_;
  const std::function<bool()> cancelled_;
  const Listener listener_;
  messages::TrainingProgress message_;
  std_msgs::Header header_;
  std::function<double(std::uint32_t)> done_ = [](std::uint32_t) { return 0.0; };
};

}  // namespace recognition
