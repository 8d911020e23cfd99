#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxName = 80;  // letters; what tells doubled names apart comes behind

nlohmann::json readInfo(const fs::path& file) {
  if (!fs::exists(file)) return nlohmann::json::object();
  std::ifstream in(file);
  try {
    return nlohmann::json::parse(in);
  } catch (const nlohmann::json::parse_error& error) {
    throw std::runtime_error(file.string() + ": is no valid JSON, from byte " + std::to_string(error.byte));
  }
}

bool mayStand(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.'; }

// Fit for a store: what is no letter, digit, '_', '-' or '.' becomes one '_', as do all bytes of a letter in UTF-8.
std::string storeName(const std::string& given) {
  std::string name;
  for (size_t i = 0; i < given.size() && name.size() < kMaxName; ++i) {
    const auto byte = static_cast<unsigned char>(given[i]);
    const bool goes_on = byte >= 0x80 && byte < 0xc0;  // a letter that began before
    if (!goes_on) name += byte < 0x80 && mayStand(given[i]) ? given[i] : '_';
  }
  while (!name.empty() && name.front() == '.') name.erase(0, 1);
  return name;
}

// Names that can all stand in one store.
void makeUnique(std::vector<BopModel>& models) {
  std::set<std::string> taken;
  for (BopModel& model : models) {
    const std::string given = model.name, stem = fs::path(model.file).stem().string();
    std::string name = storeName(given);
    if (name.empty()) name = stem;
    if (taken.count(name)) name += stem.substr(stem.find('_') == std::string::npos ? 0 : stem.find('_'));
    model.name = name;
    if (name != given) model.given_name = given;
    taken.insert(name);
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
    models.push_back({id, nameOf(info, id, stem), entry.path().string(), ""});
  }
  if (models.empty()) throw std::runtime_error(directory + ": holds no obj_NNNNNN.ply");
  std::sort(models.begin(), models.end(), [](const BopModel& a, const BopModel& b) { return a.id < b.id; });
  makeUnique(models);
  return models;
}

}  // namespace recognition
