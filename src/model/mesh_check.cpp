#include "mesh_check.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace rgbd_recognition {
namespace {

constexpr std::uint64_t kMostCorners = 5000;  // of a face; a quarter of a second, and the time goes with the square

struct Type {
  std::uint64_t size;  // bytes
  bool is_integer;
};

struct Property {
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
      {"char", {1, true}},   {"int8", {1, true}},    {"uchar", {1, true}},   {"uint8", {1, true}},
      {"short", {2, true}},  {"int16", {2, true}},   {"ushort", {2, true}},  {"uint16", {2, true}},
      {"int", {4, true}},    {"int32", {4, true}},   {"uint", {4, true}},    {"uint32", {4, true}},
      {"float", {4, false}}, {"float32", {4, false}}, {"double", {8, false}}, {"float64", {8, false}}};
  const auto found = types.find(name);
  if (found == types.end()) throw std::runtime_error("a property has the unknown type '" + name + "'");
  return found->second;
}

/// Goes once over a PLY file.
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
    if (!text.empty() && text.back() == '\r') text.pop_back();
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
      word.clear();
      words >> word;
      if (word == "end_header") return;
      if (word == "element")
        readElement(words);
      else if (word == "property")
        readProperty(words);
      else
        require(word == "comment" || word == "obj_info", "has the word '" + word + "' in its header");
    }
  }

  void readElement(std::istream& words) {
    Element element;
    words >> element.name >> element.count;
    require(words && element.count <= bytes_.size(), "element " + element.name + ": more than the file can hold");
    for (const Element& other : elements_)
      require(other.name != element.name, "element " + element.name + " is declared twice");
    require(element.name != "tristrips", "has triangle strips, not faces");
    elements_.push_back(element);
  }

  void readProperty(std::istream& words) {
    require(!elements_.empty(), "declares a property before any element");
    Property property;
    std::string type;
    words >> type;
    property.is_list = type == "list";
    if (property.is_list) {
      words >> type;
      property.length = typeOf(type);
      require(property.length.is_integer, "has a list whose length is no integer");
      words >> type;
    }
    property.value = typeOf(type);
    elements_.back().properties.push_back(property);
  }

  void passLine(const Element& element) {
    std::istringstream words(line());
    std::string word;
    for (const Property& property : element.properties) {
      std::uint64_t left = 1;
      if (property.is_list) {
        words >> left;
        require(words && left <= kMostCorners, "element " + element.name + ": a list is too long");
      }
      for (; left > 0; --left) require(bool(words >> word), "element " + element.name + ": a line is too short");
    }
  }

  void passBytes(const Element& element) {
    for (const Property& property : element.properties) {
      std::uint64_t left = 1;
      if (property.is_list) {
        left = integer(property.length.size);
        require(left <= kMostCorners, "element " + element.name + ": a list is too long");
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
  bool is_text_ = false, is_big_endian_ = false;
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
    if (words > kMostCorners) throw std::runtime_error(file + ": has a face of too many corners; split it");
    if (c != '\r') before = c;
  }
}

}  // namespace rgbd_recognition
