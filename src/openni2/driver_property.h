#pragma once

#include <Driver/OniDriverAPI.h>

#include <cstring>

namespace recognition::openni2 {

/// Answers getProperty: OpenNI2 hands over a buffer and its size, which must be the property's.
template <typename Value>
OniStatus readProperty(const Value& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof(Value))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(Value));
  return ONI_STATUS_OK;
}

/// Takes the value of a setProperty.
template <typename Value>
OniStatus writeProperty(Value* value, const void* data, int size) {
  if (size != static_cast<int>(sizeof(Value))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(value, data, sizeof(Value));
  return ONI_STATUS_OK;
}

/// A text property, cut to the buffer, always terminated.
inline OniStatus readTextProperty(const char* text, void* data, int* size) {
  if (*size < 1) return ONI_STATUS_BAD_PARAMETER;
  char* target = static_cast<char*>(data);
  std::strncpy(target, text, *size - 1);
  target[*size - 1] = '\0';
  *size = static_cast<int>(std::strlen(target)) + 1;
  return ONI_STATUS_OK;
}

}  // namespace recognition::openni2
