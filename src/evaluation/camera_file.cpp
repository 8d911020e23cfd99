#include "evaluation/camera_file.h"

#include <algorithm>
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
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.compare(0, 3, "\xef\xbb\xbf") == 0) text.erase(0, 3);  // the mark of some editors
  return text;
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

/// A list, or the list "data" of a matrix as ROS and OpenCV write it.
std::vector<double> listOf(const json& entry, const std::string& key) {
  return entry.at(key).is_object() ? numbersOf(entry.at(key), "data") : numbersOf(entry, key);
}

/// Nine numbers, or those of a matrix of three rows and four columns.
std::vector<double> matrixAt(const json& entry, const std::string& key) {
  const std::vector<double> n = listOf(entry, key);
  if (n.size() == 12) return {n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]};
  if (n.size() != 9) throw std::runtime_error(key + " has " + std::to_string(n.size()) + " numbers, not 9");
  return n;
}

void readFocalLengths(const json& entry, CameraModel* camera) {
  if (!entry.contains("fx")) throw std::runtime_error("holds no camera: no cam_K, and no fx, fy, cx, cy");
  camera->fx = numberOf(entry, "fx");
  camera->fy = numberOf(entry, "fy");
  camera->cx = numberOf(entry, entry.contains("ppx") ? "ppx" : "cx");
  camera->cy = numberOf(entry, entry.contains("ppy") ? "ppy" : "cy");
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

const std::vector<std::string>& matrixKeys() {
  static const std::vector<std::string> keys = {"cam_K", "K",   "camera_matrix", "intrinsic_matrix", "intrinsics",
                                                "k",     "mtx", "cameraMatrix",  "Camera_Matrix"};
  return keys;
}

const std::vector<std::string>& distortionKeys() {
  static const std::vector<std::string> keys = {
      "distortion_coefficients", "D", "d", "distortion", "dist_coeffs", "distCoeffs", "coeffs", "dist_coefs", "dist",
      "Distortion_Coefficients"};
  return keys;
}

std::string distortionModel(const std::string& name) {
  const std::string plain = name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1);
  if (plain == "brown_conrady" || plain == "radtan") return "plumb_bob";
  return plain == "kannala_brandt4" ? "equidistant" : plain;
}

CameraFile cameraFromJson(const json& entry) {
  CameraFile result;
  if (!entry.is_object()) throw std::runtime_error("holds no camera: no cam_K, and no fx, fy, cx, cy");
  const auto key = std::find_if(matrixKeys().begin(), matrixKeys().end(),
                                [&](const std::string& name) { return entry.contains(name); });
  if (key == matrixKeys().end())
    readFocalLengths(entry, &result.camera);
  else if (entry.at(*key).is_object() && !entry.at(*key).contains("data"))
    result = cameraFromJson(entry.at(*key));
  else
    setMatrix(matrixAt(entry, *key), &result.camera);
  if (entry.contains("depth_scale")) result.depth_scale = numberOf(entry, "depth_scale");
  if (!(result.depth_scale > 0.0)) throw std::runtime_error("depth_scale is not above 0");
  for (const char* name : {"width", "image_width"})
    if (entry.contains(name)) result.camera.width = static_cast<int>(numberOf(entry, name));
  for (const char* name : {"height", "image_height"})
    if (entry.contains(name)) result.camera.height = static_cast<int>(numberOf(entry, name));
  for (const std::string& name : distortionKeys())
    if (entry.contains(name) && (entry.at(name).is_array() || entry.at(name).is_object()))
      result.distortion.coefficients = listOf(entry, name);
  for (const char* name : {"distortion_model", "model"})
    if (entry.contains(name) && entry.at(name).is_string())
      result.distortion.model = distortionModel(entry.at(name).get<std::string>());
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
