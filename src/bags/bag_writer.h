#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/core/pose.h"
#include "bags/bag_reader.h"

namespace recognition {

/// How a bag is written.
struct BagForm {
  std::string frame_id = "camera_rgb_optical_frame";
  bool depth_as_cloud = false;  ///< an organised cloud rather than an image
  bool fast = false;            ///< packed by LZ4, not by BZ2: larger, and written faster
};

/// Writes RGB-D frames as a bag that rosbag plays and BagReader reads: colour image, depth, and camera info.
class BagWriter {
 public:
  /// Throws std::runtime_error that names the file if it cannot be written.
  BagWriter(const std::string& file, const FrameTopics& topics, const BagForm& form = {});
  ~BagWriter();

  /// `stamp`: nanoseconds. Throws std::invalid_argument for a frame that does not fit, std::runtime_error if the disk
  /// does not take it.
  void write(const RgbdFrame& frame, std::int64_t stamp);
  /// On /tf the pose of each object, by the name of its frame. Throws std::runtime_error as write().
  void writePoses(const std::map<std::string, Pose>& camera_from_objects, std::int64_t stamp);
  /// Completes the file; the destructor does so too, without telling of errors.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
