#pragma once

#include <memory>
#include <string>

#include "tools/frame_source.h"

namespace recognition {

/// Frames of a rosbag. Empty topics: openni's or the challenge's, whichever the bag holds. With `object_frame`, frames
/// have that frame's pose by the bag's tf; those of which tf tells nothing throw. Throws std::runtime_error with file
/// and reason.
std::unique_ptr<FrameSource> openBagSource(const std::string& file, const std::string& color_topic,
                                           const std::string& info_topic, const std::string& depth_topic,
                                           const std::string& object_frame = "");

}  // namespace recognition
