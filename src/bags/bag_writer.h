#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rgbd_recognition/core/frame.h"
#include "bags/bag_reader.h"

namespace recognition {

/// Writes RGB-D frames as a bag that rosbag plays and BagReader reads: colour image, depth image, and camera info.
class BagWriter {
 public:
  /// Throws std::runtime_error that names the file if it cannot be written.
  BagWriter(const std::string& file, const FrameTopics& topics,
            const std::string& frame_id = "camera_rgb_optical_frame");
  ~BagWriter();

  /// `stamp`: nanoseconds. Throws std::invalid_argument for a frame that does not fit, std::runtime_error if the disk
  /// does not take it.
  void write(const RgbdFrame& frame, std::int64_t stamp);
  /// Completes the file; the destructor does so too, without telling of errors.
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace recognition
