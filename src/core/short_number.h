#pragma once

#include <cstdio>
#include <string>

namespace recognition {

/// A number for people: three digits or as many as stand before the point ("3.6", "0.00012", "1234").
inline std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value >= 1000.0 || value <= -1000.0 ? "%.0f" : "%.3g", value);
  return text;
}

}  // namespace recognition
