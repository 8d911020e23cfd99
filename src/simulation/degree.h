#pragma once

#include <opencv2/core/cvdef.h>

namespace recognition {

constexpr double kDegree = CV_PI / 180.0;  ///< radians

}  // namespace recognition
