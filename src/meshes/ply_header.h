#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace recognition {

enum class PlyKind { kUnsigned, kSigned, kReal };

struct PlyType {
  int size = 0;  ///< bytes
  PlyKind kind = PlyKind::kReal;
};

struct PlyProperty {
  std::string name;  ///< lower case
  bool is_list = false;
  PlyType length{}, value{};
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index of the first property that has one of these names; -1 if there is none.
  int find(const std::vector<std::string>& names) const;
};

/// What a PLY file declares before its data.
struct PlyHeader {
  bool is_text = true;
  bool is_big_endian = false;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< of "comment TextureFile NAME", in order
  size_t size = 0;                    ///< bytes; the data follows
};

/// Lines may end with CR LF, have blanks at their end, or be empty. Throws std::runtime_error with the reason.
PlyHeader readPlyHeader(std::string_view bytes);

/// Throws std::runtime_error with the reason unless it is so.
inline void requirePly(bool is_so, const std::string& reason) {
  if (!is_so) throw std::runtime_error(reason);
}

}  // namespace recognition
