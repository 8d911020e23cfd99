#include "meshes/ply_values.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "meshes/raw_mesh.h"

namespace recognition {
namespace {

size_t checkedLength(double length, const PlyElement& element) {
  requirePly(length >= 0.0 && length <= static_cast<double>(kMaxCorners),
             "element " + element.name + ": a list is too long");
  return static_cast<size_t>(length);
}

bool fits(double value, PlyKind kind) {
  if (kind == PlyKind::kReal) return true;
  return value == std::floor(value) && (kind == PlyKind::kSigned || value >= 0.0);
}

template <typename T>
double valueAs(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double decode(const char* bytes, const PlyType& type) {
  const bool is_signed = type.kind == PlyKind::kSigned;
  switch (type.size) {
    case 1:
      return is_signed ? valueAs<std::int8_t>(bytes) : valueAs<std::uint8_t>(bytes);
    case 2:
      return is_signed ? valueAs<std::int16_t>(bytes) : valueAs<std::uint16_t>(bytes);
    case 4:
      if (type.kind == PlyKind::kReal) return valueAs<float>(bytes);
      return is_signed ? valueAs<std::int32_t>(bytes) : valueAs<std::uint32_t>(bytes);
    default:
      return valueAs<double>(bytes);
  }
}

}  // namespace

PlyValues::PlyValues(const PlyHeader& header, std::string_view bytes)
    : is_text_(header.is_text), is_big_endian_(header.is_big_endian), data_(bytes.substr(header.size)), lines_(data_) {}

bool PlyValues::next(const PlyElement& element, PlyRow* row) {
  if (current_ != &element) {
    current_ = &element;
    done_ = 0;
  }
  if (done_ == element.count || element.properties.empty()) return false;
  ++done_;
  is_text_ ? readLine(element, row) : readBinary(element, row);
  return true;
}

void PlyValues::readLine(const PlyElement& element, PlyRow* row) {
  std::string_view line;
  do requirePly(lines_.nextLine(&line), "ends too early");
  while (TextCursor(line).atEnd());
  TextCursor words(line);
  const auto value = [&](const PlyType& type) {
    double number = 0.0;
    requirePly(words.number(&number) && fits(number, type.kind),
               "element " + element.name + ": a line is too short, or holds what is no number");
    return number;
  };
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.is_list) {
      row->scalars[i] = value(property.value);
      continue;
    }
    row->lists[i].resize(checkedLength(value(property.length), element));
    for (double& number : row->lists[i]) number = value(property.value);
  }
}

void PlyValues::readBinary(const PlyElement& element, PlyRow* row) {
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.is_list) {
      row->scalars[i] = binaryValue(property.value);
      continue;
    }
    row->lists[i].resize(checkedLength(binaryValue(property.length), element));
    for (double& number : row->lists[i]) number = binaryValue(property.value);
  }
}

double PlyValues::binaryValue(const PlyType& type) {
  const auto size = static_cast<size_t>(type.size);
  requirePly(size <= data_.size() - at_, "ends too early");
  char bytes[8];
  std::memcpy(bytes, data_.data() + at_, size);
  if (is_big_endian_) std::reverse(bytes, bytes + size);
  at_ += size;
  return decode(bytes, type);
}

}  // namespace recognition
