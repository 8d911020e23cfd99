#pragma once

#include <string>

#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// Says why nothing can be found in a frame that validates; "" for a frame that is fit to be searched. It looks at the
/// principal point (is it in the picture, and not in a corner, as with the camera of another resolution?), the focal
/// length, whether there is any depth, and whether depth is in the range of a camera (and not ten or a thousand times
/// too large or too small).
std::string frameProblem(const RgbdFrame& frame);

/// Throws std::invalid_argument with frameProblem()'s sentence if there is one.
void requireFit(const RgbdFrame& frame);

}  // namespace recognition
