#include "evaluation/camera_file.h"

#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "evaluation/json_file.h"

namespace recognition {
namespace {

using nlohmann::json;

bool isFrameNumber(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// Whether the keys are numbers of frames, as in scene_camera.json.
bool isByFrame(const json& root) {
  if (!root.is_object() || root.empty()) return false;
  for (const auto& [key, value] : root.items())
    if (!isFrameNumber(key) || !value.is_object()) return false;
  return true;
}

const json& entryOf(const json& root, std::optional<int> frame) {
  if (!isByFrame(root)) return root;
  if (root.size() == 1) return root.begin().value();
  std::string keys;
  int listed = 0;
  for (const auto& [key, value] : root.items()) {
    if (frame && std::stod(key) == *frame) return value;
    if (++listed <= 5) keys += (keys.empty() ? "" : ", ") + key;
  }
  if (listed > 5) keys += ", ...";
  if (!frame) throw std::runtime_error("has entries for the frames " + keys + ", and the image's name has no number");
  throw std::runtime_error("has no entry for frame " + std::to_string(*frame) + ", but for " + keys);
}

std::string textOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Numbers apart from each other by blanks, commas, semicolons or brackets; nothing if there is something else.
std::vector<double> plainNumbers(std::string text) {
  for (char& c : text)
    if (c == ',' || c == ';' || c == '[' || c == ']') c = ' ';
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double value = 0.0; in >> value;) numbers.push_back(value);
  return in.eof() ? numbers : std::vector<double>();
}

CameraFile readText(const std::string& file, const std::string& text, std::optional<int> frame) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw std::runtime_error("is empty");
  if (text[first] == '{') return cameraFromJson(entryOf(readJsonFile(file), frame));
  const std::vector<double> numbers = plainNumbers(text);
  if (numbers.size() == 9 || numbers.size() == 12 || numbers.size() == 16) {  // K, or as the upper left of P
    const size_t columns = numbers.size() == 9 ? 3 : 4;
    CameraFile result;
    setMatrix({numbers[0], numbers[1], numbers[2], numbers[columns], numbers[columns + 1], numbers[columns + 2],
               numbers[2 * columns], numbers[2 * columns + 1], numbers[2 * columns + 2]},
              &result.camera);
    return result;
  }
  return text.find("camera matrix") != std::string::npos ? cameraFromIni(text) : cameraFromYaml(text);
}

}  // namespace

void setMatrix(const std::vector<double>& k, CameraModel* camera) {
  const bool by_columns = k[2] == 0.0 && k[5] == 0.0 && (k[6] != 0.0 || k[7] != 0.0);
  camera->fx = k[0];
  camera->fy = k[4];
  camera->cx = by_columns ? k[6] : k[2];
  camera->cy = by_columns ? k[7] : k[5];
  if (!(k[0] > 0.0) || !(k[4] > 0.0)) throw std::runtime_error("its camera matrix has no focal lengths above 0");
}

CameraFile cameraFromJson(const json& entry) {
  CameraFile result;
  if (!entry.is_object()) throw std::runtime_error("holds no camera: no cam_K, and no fx, fy, cx, cy");
  bool found = false;
  for (const char* key : {"cam_K", "K", "camera_matrix", "intrinsic_matrix", "intrinsics", "k"}) {
    if (found || !entry.contains(key)) continue;
    if (entry.at(key).is_object()) return cameraFromJson(entry.at(key));
    setMatrix(numbersOf(entry, key, 9), &result.camera);
    found = true;
  }
  if (!found && !entry.contains("fx"))
    throw std::runtime_error("holds no camera: no cam_K, and no fx, fy, cx, cy");
  if (!found) {
    result.camera.fx = numberOf(entry, "fx");
    result.camera.fy = numberOf(entry, "fy");
    result.camera.cx = numberOf(entry, entry.contains("ppx") ? "ppx" : "cx");
    result.camera.cy = numberOf(entry, entry.contains("ppy") ? "ppy" : "cy");
  }
  if (entry.contains("depth_scale")) result.depth_scale = numberOf(entry, "depth_scale");
  if (entry.contains("width")) result.camera.width = static_cast<int>(numberOf(entry, "width"));
  if (entry.contains("height")) result.camera.height = static_cast<int>(numberOf(entry, "height"));
  for (const char* key : {"D", "distortion", "distortion_coefficients", "dist_coeffs", "coeffs"})
    if (entry.contains(key) && entry.at(key).is_array())
      result.distortion.coefficients = numbersOf(entry, key, entry.at(key).size());
  for (const char* key : {"distortion_model", "model"})
    if (entry.contains(key) && entry.at(key).is_string()) result.distortion.model = entry.at(key).get<std::string>();
  return result;
}

CameraFile readCameraFile(const std::string& file, std::optional<int> frame) {
  try {
    return readText(file, textOf(file), frame);
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw std::runtime_error(reason.rfind(file, 0) == 0 ? reason : file + ": " + reason);
  }
}

}  // namespace recognition
