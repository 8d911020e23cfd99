#pragma once

#include <memory>
#include <string>

#include "tools/frame_source.h"

namespace recognition {

/// Where a bag's frames are. Empty topics: a known set that the bag holds, see BagReader.
struct BagTopics {
  std::string color, camera_info, depth;
  double max_interval = 0.02;  ///< between the stamps of a colour image and its depth, seconds
};

/// Frames of a rosbag. With `object_frame`, frames have that frame's pose by the bag's tf; those of which tf tells
/// nothing throw. Throws std::runtime_error with file and reason.
std::unique_ptr<FrameSource> openBagSource(const std::string& file, const BagTopics& topics,
                                           const std::string& object_frame = "");

}  // namespace recognition
