#include "meshes/ply_header.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "meshes/text_cursor.h"

namespace recognition {
namespace {

PlyType typeOf(const std::string& name) {
  static const std::map<std::string, PlyType> types = {
      {"char", {1, PlyKind::kSigned}},    {"uchar", {1, PlyKind::kUnsigned}},  {"int8", {1, PlyKind::kSigned}},
      {"uint8", {1, PlyKind::kUnsigned}}, {"short", {2, PlyKind::kSigned}},    {"ushort", {2, PlyKind::kUnsigned}},
      {"int16", {2, PlyKind::kSigned}},   {"uint16", {2, PlyKind::kUnsigned}}, {"int", {4, PlyKind::kSigned}},
      {"uint", {4, PlyKind::kUnsigned}},  {"int32", {4, PlyKind::kSigned}},    {"uint32", {4, PlyKind::kUnsigned}},
      {"float", {4, PlyKind::kReal}},     {"float32", {4, PlyKind::kReal}},    {"double", {8, PlyKind::kReal}},
      {"float64", {8, PlyKind::kReal}}};
  const auto found = types.find(name);
  requirePly(found != types.end(), "a property has the unknown type '" + name + "'");
  return found->second;
}

std::uint64_t readCount(const std::string& element, const std::string& word, size_t max) {
  const bool is_integer =
      !word.empty() && word.size() < 20 && word.find_first_not_of("0123456789") == std::string::npos;
  requirePly(is_integer && std::stoull(word) <= max, "element " + element + ": more than the file can hold");
  return std::stoull(word);
}

PlyProperty readProperty(TextCursor& words) {
  PlyProperty property;
  std::string type(words.word());
  property.is_list = type == "list";
  if (property.is_list) {
    property.length = typeOf(std::string(words.word()));
    requirePly(property.length.kind != PlyKind::kReal, "has a list whose length is no integer");
    type = std::string(words.word());
  }
  property.value = typeOf(type);
  property.name = lowerCase(std::string(words.word()));
  requirePly(!property.name.empty(), "has a property without a name");
  return property;
}

void readElement(TextCursor& words, size_t max, PlyHeader& header) {
  PlyElement element;
  element.name = lowerCase(std::string(words.word()));
  element.count = readCount(element.name, std::string(words.word()), max);
  for (const PlyElement& other : header.elements)
    requirePly(other.name != element.name, "element " + element.name + " is declared twice");
  requirePly(element.name != "tristrips", "has triangle strips, not faces");
  header.elements.push_back(element);
}

void readComment(TextCursor& words, PlyHeader& header) {
  if (lowerCase(std::string(words.word())) != "texturefile") return;
  const std::string name(words.rest());
  if (!name.empty()) header.textures.push_back(name);
}

void readFormat(std::string_view line, PlyHeader& header) {
  TextCursor words(line);
  const std::string word(words.word()), format(words.word());
  header.is_text = format == "ascii";
  header.is_big_endian = format == "binary_big_endian";
  requirePly(word == "format" && (header.is_text || header.is_big_endian || format == "binary_little_endian"),
             "is neither ascii, binary_little_endian nor binary_big_endian");
}

}  // namespace

int PlyElement::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    for (size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == name) return static_cast<int>(i);
  return -1;
}

PlyHeader readPlyHeader(std::string_view bytes) {
  PlyHeader header;
  TextCursor lines(bytes);
  const auto nextLine = [&] {
    for (std::string_view line;;) {
      requirePly(lines.nextLine(&line), "ends too early, within its header");
      if (!TextCursor(line).atEnd()) return line;
    }
  };
  requirePly(TextCursor(nextLine()).rest() == "ply", "does not begin with the line 'ply'");
  readFormat(nextLine(), header);
  for (;;) {
    TextCursor words(nextLine());
    const std::string word(words.word());
    if (word == "end_header") break;
    if (word == "element") {
      readElement(words, bytes.size(), header);
    } else if (word == "property") {
      requirePly(!header.elements.empty(), "has a property apart from its element");
      header.elements.back().properties.push_back(readProperty(words));
    } else if (word == "comment") {
      readComment(words, header);
    } else {
      requirePly(word == "obj_info", "has the word '" + word.substr(0, 40) + "' in its header");
    }
  }
  header.size = static_cast<size_t>(lines.position() - bytes.data());
  return header;
}

}  // namespace recognition
