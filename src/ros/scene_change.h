#pragma once

#include <opencv2/core.hpp>
#include <ros/time.h>

#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// Tells frames that show nothing new, so that a pipeline can rest while nothing in view moves. Compares small copies
/// of depth and colour with those of the frame that was worked on last.
class SceneChange {
 public:
  /// `longest_rest`: seconds after which a frame counts as new whatever it shows; 0: each frame does.
  explicit SceneChange(double longest_rest = 0.0) : longest_rest_(longest_rest) {}

  bool isNew(const RgbdFrame& frame, const ros::WallTime& now) const;
  /// The frame that was worked on.
  void worked(const RgbdFrame& frame, const ros::WallTime& now);
  void reset() { worked_ = ros::WallTime(); }

 private:
  struct Small {
    cv::Mat gray, depth;  // metres, 0 where unknown
  };
  static Small smallOf(const RgbdFrame& frame);

  double longest_rest_;
  Small last_;
  ros::WallTime worked_;  // zero: none yet
};

}  // namespace recognition
