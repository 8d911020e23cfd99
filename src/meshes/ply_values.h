#pragma once

#include <string_view>
#include <vector>

#include "meshes/ply_header.h"
#include "meshes/text_cursor.h"

namespace recognition {

/// One instance of an element; values stand at their property's index.
struct PlyRow {
  explicit PlyRow(const PlyElement& element) : scalars(element.properties.size()), lists(element.properties.size()) {}
  std::vector<double> scalars;
  std::vector<std::vector<double>> lists;
};

/// The data of a PLY file, instance by instance. Throws std::runtime_error where it is not what the header declares.
class PlyValues {
 public:
  PlyValues(const PlyHeader& header, std::string_view bytes);

  /// The next instance of `element`; false once all of them were read. A zero-sized element has none.
  bool next(const PlyElement& element, PlyRow* row);

 private:
  void readLine(const PlyElement& element, PlyRow* row);
  void readBinary(const PlyElement& element, PlyRow* row);
  double binaryValue(const PlyType& type);

  bool is_text_, is_big_endian_;
  std::string_view data_;
  size_t at_ = 0;     // in data_, if binary
  TextCursor lines_;  // if text
  const PlyElement* current_ = nullptr;
  std::uint64_t done_ = 0;  // instances of the current element
};

}  // namespace recognition
