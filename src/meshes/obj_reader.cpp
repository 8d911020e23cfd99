#include <filesystem>
#include <map>
#include <stdexcept>

#include "meshes/files_beside.h"
#include "meshes/mesh_readers.h"
#include "meshes/text_cursor.h"

namespace recognition {
namespace {

class ObjReader {
 public:
  explicit ObjReader(const std::string& file) : file_(file) {}

  RawMesh read(std::string_view bytes) {
    TextCursor lines(bytes);
    for (std::string_view line; lines.nextLine(&line);) {
      ++number_;
      if (!line.empty() && line.back() == '\\') line = joined(line, lines);
      readLine(TextCursor(line));
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("line " + std::to_string(number_) + " " + what);
  }

  // The line and those behind it, as far as each ends with a backslash.
  std::string_view joined(std::string_view line, TextCursor& lines) {
    joined_ = line;
    while (!joined_.empty() && joined_.back() == '\\') {
      joined_.back() = ' ';
      if (!lines.nextLine(&line)) break;
      ++number_;
      joined_ += line;
    }
    return joined_;
  }

  void readLine(TextCursor words) {
    const std::string_view key = words.word();
    if (key == "v")
      readVertex(words);
    else if (key == "vt")
      readCoordinate(words);
    else if (key == "vn")
      readNormal(words);
    else if (key == "f")
      readFace(words);
    else if (key == "usemtl")
      useMaterial(std::string(words.rest()));
    else if (key == "mtllib")
      readLibraries(std::string(words.rest()));
  }

  double number(TextCursor& words) const {
    double value = 0.0;
    if (!words.number(&value)) fail("is too short, or holds what is no number");
    return value;
  }

  void readVertex(TextCursor& words) {
    const double x = number(words), y = number(words), z = number(words);
    mesh_.positions.emplace_back(x, y, z);
    cv::Vec3d rgb;
    for (int k = 0; k < 3; ++k)
      if (!words.number(&rgb[k])) return;
    for (int k = 0; k < 3; ++k) color_scale_.see(rgb[k]);
    colors_.push_back(rgb);
  }

  void readCoordinate(TextCursor& words) {
    const double u = number(words);
    double v = 0.0;
    words.number(&v);
    mesh_.coordinates.emplace_back(static_cast<float>(u), static_cast<float>(v));
  }

  void readNormal(TextCursor& words) {
    const double x = number(words), y = number(words), z = number(words);
    mesh_.normals.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }

  // From 1, or backwards from the last one with a minus. What is out of range is found later.
  static std::int64_t indexOf(std::int64_t value, size_t count) {
    return value > 0 ? value - 1 : value < 0 ? static_cast<std::int64_t>(count) + value : -2;
  }

  void readFace(TextCursor& words) {
    RawFace face{mesh_.corners.size(), 0, material_};
    while (!words.atEnd()) {
      RawCorner corner;
      std::int64_t value = 0;
      if (!words.integer(&value)) fail("has a face with a corner that is no number");
      corner.position = indexOf(value, mesh_.positions.size());
      if (words.take('/')) {
        if (words.integer(&value)) corner.coordinate = indexOf(value, mesh_.coordinates.size());
        if (words.take('/') && words.integer(&value)) corner.normal = indexOf(value, mesh_.normals.size());
      }
      mesh_.corners.push_back(corner);
      if (++face.count > kMaxCorners) fail("has a face of too many corners; split it");
    }
    if (face.count > 0) mesh_.faces.push_back(face);
  }

  void useMaterial(const std::string& name) {
    used_.emplace(name, used_.size());
    material_ = static_cast<int>(used_.at(name));
  }

  // One name with blanks in it, or several names.
  void readLibraries(const std::string& names) {
    libraries_ += (libraries_.empty() ? "" : ", ") + names;
    if (const auto found = findBeside(file_, names)) return readLibrary(*found);
    TextCursor words(names);
    for (std::string name; !(name = std::string(words.word())).empty();) {
      if (const auto found = findBeside(file_, name))
        readLibrary(*found);
      else
        missing_library_ = name;
    }
  }

  void readLibrary(const std::string& file) {
    for (RawMaterial& material : readMtl(readTextBytes(file))) known_.emplace(material.name, std::move(material));
  }

  void finish() {
    if (colors_.size() == mesh_.positions.size())
      for (const cv::Vec3d& rgb : colors_) mesh_.position_colors.push_back(color_scale_.apply(rgb));
    const bool is_colored = !mesh_.position_colors.empty();
    if (!missing_library_.empty() && !is_colored)
      throw std::runtime_error("its material library " + missing_library_ +
                               " is missing (looked for beside the mesh, too)");
    if (used_.empty() && known_.size() == 1) {  // some programs name no material where there is one only
      mesh_.materials.push_back(known_.begin()->second);
      for (RawFace& face : mesh_.faces) face.material = 0;
    }
    mesh_.materials.resize(std::max(mesh_.materials.size(), used_.size()));
    for (const auto& [name, index] : used_) {
      const auto found = known_.find(name);
      if (found == known_.end() && !libraries_.empty() && !is_colored)
        throw std::runtime_error("its material '" + name + "' is not in " + libraries_);
      if (found != known_.end()) mesh_.materials[index] = found->second;
    }
  }

  const std::string file_;
  RawMesh mesh_;
  std::vector<cv::Vec3d> colors_;  // of the vertices
  ColorScale color_scale_;
  std::map<std::string, size_t> used_;        // material -> index
  std::map<std::string, RawMaterial> known_;  // of the libraries
  std::string libraries_, missing_library_, joined_;
  int material_ = -1;
  int number_ = 0;  // of the line
};

// Behind the options of map_Kd, each with its values. Throws where one changes what is seen.
std::string textureName(TextCursor words) {
  static const std::map<std::string, int> values = {{"-blendu", 1}, {"-blendv", 1}, {"-cc", 1}, {"-clamp", 1},
                                                    {"-texres", 1}, {"-boost", 1},  {"-bm", 1}, {"-imfchan", 1},
                                                    {"-type", 1},   {"-mm", 2}};
  for (;;) {
    TextCursor ahead = words;
    const std::string word = lowerCase(std::string(ahead.word()));
    if (word == "-o" || word == "-s" || word == "-t") {
      const double neutral = word == "-s" ? 1.0 : 0.0;
      for (double value = 0.0;;) {
        TextCursor next = ahead;
        if (!next.number(&value)) break;
        if (value != neutral && word != "-t")
          throw std::runtime_error("a texture is moved or scaled (map_Kd " + word + "), which is not read");
        ahead = next;
      }
    } else if (const auto found = values.find(word); found != values.end()) {
      for (int i = 0; i < found->second; ++i) ahead.word();
    } else {
      return std::string(words.rest());
    }
    words = ahead;
  }
}

}  // namespace

std::vector<RawMaterial> readMtl(const std::string& bytes) {
  std::vector<RawMaterial> materials;
  std::vector<std::string> ambient;  // textures, for materials that have no other
  TextCursor lines(bytes);
  for (std::string_view line; lines.nextLine(&line);) {
    TextCursor words(line);
    const std::string key = lowerCase(std::string(words.word()));
    if (key == "newmtl") {
      materials.push_back({std::string(words.rest()), "", std::nullopt, {}});
      ambient.emplace_back();
    }
    if (materials.empty()) continue;
    if (key == "map_kd") materials.back().texture = textureName(words);
    if (key == "map_ka") ambient.back() = textureName(words);
    cv::Vec3d rgb;
    if (key == "kd" && words.number(&rgb[0]) && words.number(&rgb[1]) && words.number(&rgb[2]))
      materials.back().color =
          cv::Vec3b(cv::saturate_cast<uchar>(255.0 * rgb[0]), cv::saturate_cast<uchar>(255.0 * rgb[1]),
                    cv::saturate_cast<uchar>(255.0 * rgb[2]));
  }
  for (size_t i = 0; i < materials.size(); ++i)
    if (materials[i].texture.empty()) materials[i].texture = ambient[i];
  return materials;
}

RawMesh readObj(const std::string& bytes, const std::string& file) { return ObjReader(file).read(bytes); }

}  // namespace recognition
