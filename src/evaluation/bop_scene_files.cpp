#include "evaluation/bop_scene_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxDigits = 9;
const std::string kCamera = "scene_camera";

bool isImage(std::string extension) {
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> known = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp"};
  return known.count(extension) > 0;
}

bool isNumber(const std::string& text) {
  return !text.empty() && text.size() <= kMaxDigits && text.find_first_not_of("0123456789") == std::string::npos;
}

/// What stands behind scene_camera in the names of the scene's files, by sensor.
std::set<std::string> endingsOf(const std::string& scene) {
  std::set<std::string> endings;
  for (const auto& entry : fs::directory_iterator(scene)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".json" && stem.rfind(kCamera + "_", 0) == 0)
      endings.insert(stem.substr(kCamera.size()));
  }
  return endings;
}

/// "_photoneo" of the sensor asked for, or of the only one.
std::string endingOf(const std::string& scene, const std::string& sensor) {
  if (!sensor.empty()) return "_" + sensor;
  if (fs::exists(fs::path(scene) / (kCamera + ".json"))) return "";
  const std::set<std::string> endings = endingsOf(scene);
  if (endings.empty()) throw std::runtime_error(scene + ": has no scene_camera.json");
  if (endings.size() == 1) return *endings.begin();
  std::string names;
  for (const std::string& ending : endings) names += (names.empty() ? "" : ", ") + ending.substr(1);
  throw std::runtime_error(scene + ": is of several sensors (" + names + "); choose one with --sensor");
}

}  // namespace

NumberedImages::NumberedImages(const std::string& folder) : folder_(folder) {
  if (!fs::is_directory(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (!isNumber(path.stem().string()) || !isImage(path.extension().string())) continue;
    std::string& file = files_[std::stoi(path.stem().string())];
    if (file.empty() || path.extension() == ".png") file = path.string();  // the one without loss, if there are two
  }
}

std::string NumberedImages::find(int number) const {
  const auto found = files_.find(number);
  return found == files_.end() ? "" : found->second;
}

bool BopSceneFiles::hasCameras(const std::string& scene) {
  return fs::exists(fs::path(scene) / (kCamera + ".json")) || !endingsOf(scene).empty();
}

BopSceneFiles::BopSceneFiles(const std::string& scene, const std::string& sensor)
    : scene_(scene),
      ending_(endingOf(scene, sensor)),
      rgb_(folderNamed("rgb")),
      gray_(folderNamed("gray")),
      depth_(folderNamed("depth")) {}

std::string BopSceneFiles::folderNamed(const std::string& name) const {
  return (fs::path(scene_) / (name + ending_)).string();
}

std::string BopSceneFiles::fileNamed(const std::string& name) const {
  return (fs::path(scene_) / (name + ending_ + ".json")).string();
}

std::string BopSceneFiles::existing(const std::string& name) const {
  const std::string file = fileNamed(name), plain = (fs::path(scene_) / (name + ".json")).string();
  return fs::exists(file) ? file : fs::exists(plain) ? plain : "";
}

}  // namespace recognition
