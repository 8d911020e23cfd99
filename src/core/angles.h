#pragma once

namespace recognition {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180.0;  ///< in radians

}  // namespace recognition
