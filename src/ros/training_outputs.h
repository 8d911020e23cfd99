#pragma once

#include <image_transport/publisher.h>
#include <ros/publisher.h>
#include <ros/time.h>

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "ros/training_messages.h"

namespace recognition {

/// What people see of a training. Pictures and clouds are made only while somebody listens. Not for concurrent use,
/// beside one thread for showView() and one for the others.
class TrainingOutputs {
 public:
  ros::Publisher progress, cloud, live_cloud, object, object_markers, tf;
  image_transport::Publisher view, coverage;
  std::string board_frame;  ///< of the clouds, and the child of the camera's frame on tf

  /// Somebody looks at the camera's view even without a training.
  bool viewWanted() const { return view.getNumSubscribers() > 0 || live_cloud.getNumSubscribers() > 0; }
  /// The frame with the object cut out, and the object's points; `recorded` with the board's pose, if it was found.
  void showView(const RecordedView& recorded, const RecordingParameters& parameters, const std_msgs::Header& header,
                const std::string& text) const;

  /// To be called now and then: while no board is seen, its frame hangs on `<board_frame>_waiting`, so that who looks
  /// (rviz) knows it.
  void showWaiting() const;

  /// The cloud so far (now and then only), and the directions seen so far.
  void showObject(const RecordedObject& recorded, const std_msgs::Header& header);
  void showProgress(const messages::TrainingProgress& message) const;
  /// Forgets an earlier training's cloud.
  void clear(const std_msgs::Header& header);

  /// A model as a cloud and as its ellipsoid.
  void showModel(const ObjectModel& model, const std_msgs::Header& header) const;

 private:
  ros::WallTime cloud_shown_;
  mutable std::atomic<std::uint64_t> board_shown_{0};  // nanoseconds of the wall
};

}  // namespace recognition
