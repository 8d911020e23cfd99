#include <algorithm>
#include <locale>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "evaluation/camera_file.h"

namespace recognition {
namespace {

constexpr size_t kP = 12;  // numbers of a projection matrix

void setRectified(const std::vector<double>& p, CameraFile* file) {
  if (p.size() != kP || !(p[0] > 0.0) || !(p[5] > 0.0)) return;
  file->rectified = CameraModel{file->camera.width, file->camera.height, p[0], p[5], p[2], p[6]};
}

/// A list, or the list `data` of a matrix.
std::vector<double> numbersAt(const YAML::Node& root, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    const YAML::Node node = root[key];
    if (!node) continue;
    const YAML::Node list = node.IsMap() ? node["data"] : node;
    std::vector<double> numbers;
    for (const YAML::Node& part : list)
      if (part.IsSequence())
        for (const YAML::Node& value : part) numbers.push_back(value.as<double>());
      else
        numbers.push_back(part.as<double>());
    return numbers;
  }
  return {};
}

double numberAt(const YAML::Node& root, const std::vector<std::string>& keys, double otherwise) {
  for (const std::string& key : keys)
    if (root[key]) return root[key].as<double>();
  return otherwise;
}

CameraFile fromRoot(const YAML::Node& root) {
  if (!root.IsMap()) throw std::runtime_error("holds no camera");
  CameraFile file;
  file.camera.width = static_cast<int>(numberAt(root, {"image_width", "width"}, 0.0));
  file.camera.height = static_cast<int>(numberAt(root, {"image_height", "height"}, 0.0));
  const std::vector<double> k = numbersAt(root, matrixKeys());
  if (k.size() == 9) {
    setMatrix(k, &file.camera);
  } else if (root["fx"]) {
    file.camera.fx = numberAt(root, {"fx"}, 0.0);
    file.camera.fy = numberAt(root, {"fy"}, 0.0);
    file.camera.cx = numberAt(root, {"cx", "ppx"}, 0.0);
    file.camera.cy = numberAt(root, {"cy", "ppy"}, 0.0);
  } else {
    throw std::runtime_error("holds no camera: no camera_matrix of nine numbers, and no fx, fy, cx, cy");
  }
  file.depth_scale = numberAt(root, {"depth_scale"}, 1.0);
  file.distortion.coefficients = numbersAt(root, distortionKeys());
  if (root["distortion_model"]) file.distortion.model = distortionModel(root["distortion_model"].as<std::string>());
  setRectified(numbersAt(root, {"projection_matrix", "P", "p"}), &file);
  return file;
}

/// The numbers in the lines behind a title, up to a line that has other words.
std::vector<double> numbersBehind(const std::string& text, const std::string& title) {
  std::istringstream lines(text);
  std::vector<double> numbers;
  bool is_behind = false;
  for (std::string line; std::getline(lines, line);) {
    if (!is_behind) {
      is_behind = line.find(title) == 0;
      continue;
    }
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    double value = 0.0;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (!(words >> value)) break;
    do numbers.push_back(value);
    while (words >> value);
  }
  return numbers;
}

}  // namespace

CameraFile cameraFromYaml(const std::string& text) {
  try {
    const bool is_opencv = text.rfind("%YAML:", 0) == 0;  // which is no yaml by the book
    return fromRoot(YAML::Load(is_opencv ? text.substr(std::min(text.find('\n'), text.size())) : text));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error("is no camera as JSON, yaml, ini or nine numbers (line " +
                             std::to_string(error.mark.line + 1) + ")");
  }
}

CameraFile cameraFromIni(const std::string& text) {
  CameraFile file;
  const std::vector<double> width = numbersBehind(text, "width"), height = numbersBehind(text, "height");
  if (!width.empty()) file.camera.width = static_cast<int>(width.front());
  if (!height.empty()) file.camera.height = static_cast<int>(height.front());
  const std::vector<double> k = numbersBehind(text, "camera matrix");
  if (k.size() != 9) throw std::runtime_error("its camera matrix has " + std::to_string(k.size()) + " numbers, not 9");
  setMatrix(k, &file.camera);
  file.distortion.coefficients = numbersBehind(text, "distortion");
  if (file.distortion.coefficients.size() == 8) file.distortion.model = "rational_polynomial";
  setRectified(numbersBehind(text, "projection"), &file);
  return file;
}

}  // namespace recognition
