#pragma once

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>

#include "bags/bag_reader.h"
#include "ros/image_conversions.h"
#include "ros/object_tf.h"
#include "ros/training_messages.h"

namespace recognition {

/// Hands a camera's frames from the thread that receives them to one that works on them; while that works, newer frames
/// take the place of older ones.
class LatestFrame {
 public:
  /// From now on frames are taken; what waited is gone.
  void open();
  /// Ends a take() that waits.
  void close();
  bool isOpen() const;

  void offer(const FrameMessages& frame);
  /// Waits for a frame; nothing after `seconds` without one, or if closed.
  std::optional<FrameMessages> take(double seconds);

 private:
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::optional<FrameMessages> frame_;
  bool open_ = false;
};

/// Where the camera is, in a training without a board: the world is the frame that tf has of the object, moved to where
/// the object stands.
class TfPoses {
 public:
  /// From the bag or from tf as it is published, whichever the request asks for. Throws as ObjectTf does.
  explicit TfPoses(const messages::TrainObjectRequest& request);

  /// Throws std::runtime_error as ObjectTf::cameraFromObject().
  Pose cameraFromWorld(const std_msgs::Header& image) const;

 private:
  ObjectTf tf_;
  Pose object_from_world_;
  double patience_;
};

/// The views of a bag.
class BagViews {
 public:
  /// Throws std::runtime_error with file and reason.
  explicit BagViews(const messages::TrainObjectRequest& request);

  /// As ViewSource; the pixels live until the next call. One more throws at the end if there were colour images without
  /// depth or camera info.
  bool next(RecordedView* view);
  /// Of the view read last.
  std_msgs::Header header() const;
  /// Share of the bag that is read, at most 1.
  double done() const { return number_ / std::max(1.0, static_cast<double>(reader_.colorImages())); }

 private:
  BagReader reader_;
  std::optional<TfPoses> poses_;
  RecordedFrame current_;
  int number_ = 0;
  bool told_ = false;  // of what was skipped
};

}  // namespace recognition
