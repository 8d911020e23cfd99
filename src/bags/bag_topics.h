#pragma once

#include <optional>
#include <string>

#include "bags/bag_file.h"
#include "bags/bag_reader.h"

namespace recognition {

/// A topic's name without the slash in front.
std::string plainName(const std::string& topic);

/// The topics of a bag's frames, named as they stand in it: those asked for, or a known set in whatever namespace. A
/// topic that is there only as image_transport compresses it (X/compressed, X/compressedDepth) is taken so. Throws
/// std::runtime_error that says what is missing or of another type, with the topics that are there.
FrameTopics chooseTopics(const BagFile& bag, const std::optional<FrameTopics>& wanted);

}  // namespace recognition
