#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// Topics of an RGB-D recording. `depth` may hold registered depth images or organised point clouds. A leading slash
/// makes no difference; images may be compressed, as image_transport does (X/compressed, X/compressedDepth).
struct FrameTopics {
  std::string color;
  std::string camera_info;  ///< of the colour camera
  std::string depth;
};

FrameTopics openniTopics();
FrameTopics challengeTopics();

/// One frame of a recording; the pixels live as long as a copy of `owner`.
struct RecordedFrame {
  RgbdFrame frame;
  std::int64_t stamp = 0;  ///< of the colour image, nanoseconds
  std::string frame_id;    ///< of the colour image
  std::shared_ptr<const void> owner;
};

/// Reads the RGB-D frames of a bag in order of time, without a ROS master. Colour that is not rectified (by its topic's
/// name) is undistorted by its camera info, and so is depth unless its topic's name says that it is rectified.
class BagReader {
 public:
  /// `max_interval`: largest difference of stamps between a colour image and its depth, seconds. Throws
  /// std::runtime_error that names the file and what is wrong: unreadable, or a topic that is not in it (with those
  /// that are).
  BagReader(const std::string& file, const FrameTopics& topics, double max_interval = 0.02);
  /// Takes the topics from the bag: openni's, the challenge's, RealSense's, Azure's or TUM's, in whatever namespace.
  explicit BagReader(const std::string& file, double max_interval = 0.02);
  ~BagReader();

  /// The next frame, or false at the end. Throws std::runtime_error with file, stamp and reason for a frame that cannot
  /// be read; the call after that goes on with the next.
  bool next(RecordedFrame* frame);

  /// Colour images in the bag: an upper bound of the frames, for progress.
  int colorImages() const;
  /// Colour images so far for which there was no depth or no camera info.
  int skipped() const;
  /// What was skipped and why, and what was changed, for people; "" if nothing was.
  std::string remarks() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
