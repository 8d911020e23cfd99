#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

nlohmann::json readInfo(const fs::path& file) {
  if (!fs::exists(file)) return nlohmann::json::object();
  std::ifstream in(file);
  try {
    return nlohmann::json::parse(in);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

std::string nameOf(const nlohmann::json& info, int id, const std::string& fallback) {
  const auto entry = info.find(std::to_string(id));
  if (entry == info.end() || !entry->is_object()) return fallback;
  const auto name = entry->find("name");
  return name != entry->end() && name->is_string() ? name->get<std::string>() : fallback;
}

}  // namespace

std::vector<BopModel> listBopModels(const std::string& directory) {
  if (!fs::is_directory(directory)) throw std::runtime_error(directory + ": is no directory");
  const nlohmann::json info = readInfo(fs::path(directory) / "models_info.json");
  std::vector<BopModel> models;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string stem = entry.path().stem().string();
    int id = 0;
    char rest = 0;
    if (entry.path().extension() != ".ply" || std::sscanf(stem.c_str(), "obj_%6d%c", &id, &rest) != 1) continue;
    models.push_back({id, nameOf(info, id, stem), entry.path().string()});
  }
  if (models.empty()) throw std::runtime_error(directory + ": holds no obj_NNNNNN.ply");
  std::sort(models.begin(), models.end(), [](const BopModel& a, const BopModel& b) { return a.id < b.id; });
  return models;
}

}  // namespace recognition
