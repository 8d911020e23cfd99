#include "meshes/mesh_check.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace recognition {
namespace {

constexpr std::uint64_t kMaxCorners = 5000;  // of a face; a quarter of a second, and the time goes with the square

enum class Kind { kUnsigned, kSigned, kReal };

struct Type {
  std::uint64_t size = 0;  // bytes
  Kind kind = Kind::kReal;
};

struct Property {
  std::string name;
  bool is_list = false;
  Type length{}, value{};
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

Type typeOf(const std::string& name) {
  static const std::map<std::string, Type> types = {
      {"char", {1, Kind::kSigned}},    {"uchar", {1, Kind::kUnsigned}},
      {"int8", {1, Kind::kSigned}},    {"uint8", {1, Kind::kUnsigned}},
      {"short", {2, Kind::kSigned}},   {"ushort", {2, Kind::kUnsigned}},
      {"int16", {2, Kind::kSigned}},   {"uint16", {2, Kind::kUnsigned}},
      {"int", {4, Kind::kSigned}},     {"uint", {4, Kind::kUnsigned}},
      {"int32", {4, Kind::kSigned}},   {"uint32", {4, Kind::kUnsigned}},
      {"float", {4, Kind::kReal}},     {"float32", {4, Kind::kReal}},
      {"double", {8, Kind::kReal}},    {"float64", {8, Kind::kReal}}};
  const auto found = types.find(name);
  if (found == types.end()) throw std::runtime_error("a property has the unknown type '" + name + "'");
  return found->second;
}

bool isInteger(const std::string& word) {
  return !word.empty() && word.size() < 20 && word.find_first_not_of("0123456789") == std::string::npos;
}

/// As Assimp reads numbers: what it does not take for one it would leave for the next value.
bool isNumber(const std::string& word, Kind kind) {
  const std::string unsigned_word = word[0] == '-' ? word.substr(1) : word;
  if (kind == Kind::kUnsigned) return isInteger(word);
  if (kind == Kind::kSigned) return isInteger(unsigned_word);
  if (unsigned_word == "nan" || unsigned_word == "inf") return true;
  char* end = nullptr;
  std::strtod(word.c_str(), &end);
  return *end == '\0' && word.find_first_not_of("0123456789+-.eE") == std::string::npos;
}

/// Goes once over a PLY file. Where it is stricter than the format, Assimp (5.2) would take one value for another.
class PlyFile {
 public:
  explicit PlyFile(std::string bytes) : bytes_(std::move(bytes)) {}

  void check() {
    readHeader();
    for (const Element& element : elements_)
      for (std::uint64_t i = 0; i < element.count; ++i) is_text_ ? passLine(element) : passBytes(element);
  }

 private:
  static void require(bool is_so, const std::string& what) {
    if (!is_so) throw std::runtime_error(what);
  }

  /// The next line without its end. No byte is in it that Assimp takes for another end.
  std::string line() {
    require(at_ < bytes_.size(), "ends too early");
    const size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::string text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (is_text_ && !text.empty() && text.back() == '\r') text.pop_back();
    const auto is_control = [](char c) { return c >= 0 && c < ' ' && c != '\t'; };
    require(std::none_of(text.begin(), text.end(), is_control), "has a control character in a line of text");
    return text;
  }

  void readHeader() {
    require(line() == "ply", "does not begin with the line 'ply'");
    std::string word, format;
    std::istringstream(line()) >> word >> format;
    is_text_ = format == "ascii";
    is_big_endian_ = format == "binary_big_endian";
    require(word == "format" && (is_text_ || is_big_endian_ || format == "binary_little_endian"),
            "is neither ascii, binary_little_endian nor binary_big_endian");
    for (;;) {
      std::istringstream words(line());
      const std::string before = std::exchange(word, "");
      words >> word;
      if (word == "end_header") return;
      if (word == "element") {
        readElement(words);
      } else if (word == "property") {
        require(before == "element" || before == "property", "has a property apart from its element");
        readProperty(words);
      } else {
        require(word == "comment" || word == "obj_info", "has the word '" + word + "' in its header");
      }
    }
  }

  void readElement(std::istream& words) {
    Element element;
    std::string count;
    words >> element.name >> count;
    require(isInteger(count) && std::stoull(count) <= bytes_.size(),
            "element " + element.name + ": more than the file can hold");
    element.count = std::stoull(count);
    for (const Element& other : elements_)
      require(other.name != element.name, "element " + element.name + " is declared twice");
    require(element.name != "tristrips", "has triangle strips, not faces");
    const bool is_known = element.name == "vertex" || element.name == "face" || element.name == "edge";
    require(is_known || is_behind_faces_, "element " + element.name + " stands before the faces");
    is_behind_faces_ |= element.name == "face";
    elements_.push_back(element);
  }

  void readProperty(std::istream& words) {
    Property property;
    std::string type;
    words >> type;
    property.is_list = type == "list";
    if (property.is_list) {
      words >> type;
      property.length = typeOf(type);
      require(property.length.kind != Kind::kReal, "has a list whose length is no integer");
      words >> type;
    }
    property.value = typeOf(type);
    require(bool(words >> property.name), "has a property without a name");
    elements_.back().properties.push_back(property);
  }

  static void checkLength(std::uint64_t length, const Element& element, const Property& property) {
    require(length <= kMaxCorners, "element " + element.name + ": a list is too long");
    const bool is_corners = property.name == "vertex_indices" || property.name == "vertex_index";
    require(length > 0 || !is_corners, "has a face without corners");  // which Assimp aborts the process for
  }

  void passLine(const Element& element) {
    std::istringstream words(line());
    std::string word;
    for (const Property& property : element.properties) {
      std::uint64_t left = 1;
      if (property.is_list) {
        left = words >> word && isInteger(word) ? std::stoull(word) : kMaxCorners + 1;
        checkLength(left, element, property);
      }
      for (; left > 0; --left)
        require(words >> word && isNumber(word, property.value.kind),
                "element " + element.name + ": a line is too short, or holds what is no number");
    }
  }

  void passBytes(const Element& element) {
    for (const Property& property : element.properties) {
      std::uint64_t left = 1;
      if (property.is_list) {
        left = integer(property.length.size);
        checkLength(left, element, property);
      }
      pass(left * property.value.size);
    }
  }

  /// Unsigned: a length below 0 is a huge one.
  std::uint64_t integer(std::uint64_t size) {
    const size_t begin = at_;
    pass(size);
    std::uint64_t value = 0;
    for (std::uint64_t i = 0; i < size; ++i) {
      const size_t next = is_big_endian_ ? begin + i : begin + size - 1 - i;
      value = value << 8 | static_cast<unsigned char>(bytes_[next]);
    }
    return value;
  }

  void pass(std::uint64_t bytes) {
    require(bytes <= bytes_.size() - at_, "ends too early");
    at_ += bytes;
  }

  std::string bytes_;
  size_t at_ = 0;
  bool is_text_ = true, is_big_endian_ = false, is_behind_faces_ = false;
  std::vector<Element> elements_;
};

std::string contentsOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

void checkPly(const std::string& file) {
  try {
    PlyFile(contentsOf(file)).check();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

void checkObj(const std::string& file) {
  std::uint64_t words = 0;  // of the line
  char before = ' ';
  for (const char c : contentsOf(file)) {
    const bool is_end = c == '\n' || c == '\r';
    if (is_end && before != '\\') words = 0;  // else the line goes on
    words += c > ' ' && before <= ' ';
    if (words > kMaxCorners) throw std::runtime_error(file + ": has a face of too many corners; split it");
    if (c != '\r') before = c;
  }
}

}  // namespace recognition
