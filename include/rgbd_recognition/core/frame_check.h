#pragma once

#include <string>

#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// Why nothing can be found in a frame that validates, as a sentence about it; "" for a frame that is fit to be
/// searched. Asked are: the principal point (in the picture, and not in a corner as with the camera of another
/// resolution), the focal length, whether depth is measured at all, and whether it is in the range of a camera (depth
/// ten or a thousand times too large or too small).
std::string frameProblem(const RgbdFrame& frame);

/// Throws std::invalid_argument with the same.
void requireFit(const RgbdFrame& frame);

}  // namespace recognition
