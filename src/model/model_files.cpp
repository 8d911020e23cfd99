#include "model/model_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "model/durable_file.h"
#include "model/model_records.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

constexpr int kFormatVersion = 2;  // 2: one scale for all descriptors
constexpr const char* kCloudFile = "cloud.pcd";
constexpr const char* kChecksumKey = "description_crc32: ";  // the last line of model.yaml, over all lines before it
constexpr float kPlaneTolerance = 0.01f;
constexpr float kFarthestPlane = 10.0f;  // metres from the object's origin
constexpr double kMaxExtent = 60.0;      // of Sigma, metres: six sigma of the largest mesh is below

std::string featureFile(DescriptorType type) { return std::string("features_") + descriptorName(type) + ".pcd"; }

YAML::Node fileNode(const std::string& bytes, size_t count) {
  YAML::Node node;
  node["count"] = count;
  node["crc32"] = checksum(bytes);
  return node;
}

std::string describe(const ObjectModel& model, const ModelFiles& files) {
  YAML::Emitter out;
  out.SetDoublePrecision(9);
  out << YAML::BeginMap;
  out << YAML::Key << "format_version" << YAML::Value << kFormatVersion;
  out << YAML::Key << "name" << YAML::Value << model.name;
  out << YAML::Key << "challenge_id" << YAML::Value << model.challenge_id;
  out << YAML::Key << "source" << YAML::Value << model.source;
  out << YAML::Key << "provenance" << YAML::Value << model.provenance;
  out << YAML::Key << "extents" << YAML::Comment("Sigma of eq. (4), metres") << YAML::BeginMap;
  out << YAML::Key << "sigma_min" << YAML::Value << model.extents.sigma_min;
  out << YAML::Key << "sigma_max" << YAML::Value << model.extents.sigma_max;
  out << YAML::Key << "sigma_d" << YAML::Value << model.extents.sigma_d << YAML::EndMap;
  if (!model.rest_planes.empty()) {
    out << YAML::Key << "rest_planes" << YAML::Comment("on which it stood: normal, offset in metres") << YAML::BeginSeq;
    for (const RestPlane& plane : model.rest_planes)
      out << YAML::Flow << std::vector<float>{plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset};
    out << YAML::EndSeq;
  }
  out << YAML::Key << "cloud" << YAML::Value << fileNode(files.at(kCloudFile), model.cloud.size());
  out << YAML::Key << "features" << YAML::Value << YAML::BeginMap;
  for (const auto& [type, features] : model.features)
    out << YAML::Key << descriptorName(type) << YAML::Value
        << fileNode(files.at(featureFile(type)), static_cast<size_t>(features.count()));
  out << YAML::EndMap << YAML::EndMap;
  const std::string text = std::string(out.c_str()) + "\n";
  return text + kChecksumKey + "\"" + checksum(text) + "\"\n";
}

YAML::Node parseDescription(const std::string& text) {
  const YAML::Node node = YAML::Load(text);
  if (!node.IsMap() || !node["format_version"]) throw std::runtime_error("is no description of a model");
  const int version = node["format_version"].as<int>();
  if (version > kFormatVersion)
    throw std::runtime_error("is of format " + std::to_string(version) + ", newer than this program's " +
                             std::to_string(kFormatVersion));
  const size_t end = text.rfind(kChecksumKey);
  if (end == std::string::npos || text.substr(end) != kChecksumKey + ("\"" + checksum(text.substr(0, end)) + "\"\n"))
    throw std::runtime_error("is damaged (checksum)");
  return node;
}

void requirePlausible(const Extents& extents) {
  for (const double value : {extents.sigma_min, extents.sigma_max, extents.sigma_d})
    if (!(value >= 0.0 && value < kMaxExtent))
      throw std::runtime_error("has an extent of " + std::to_string(value) + " m");
}

RestPlane decodeRestPlane(const YAML::Node& node) {
  const auto values = node.as<std::array<float, 4>>();
  const RestPlane plane{{values[0], values[1], values[2]}, values[3]};
  if (!(std::abs(plane.normal.norm() - 1.0f) < kPlaneTolerance && std::abs(plane.offset) < kFarthestPlane))
    throw std::runtime_error("has a rest plane that cannot be");
  return plane;
}

template <typename Decode>
auto decodeFile(const std::string& file, const YAML::Node& node,
                const std::function<std::string(const std::string&)>& read, Decode decode) {
  const std::string bytes = read(file);
  if (checksum(bytes) != node["crc32"].as<std::string>()) throw std::runtime_error(file + " is damaged (checksum)");
  try {
    return decode(bytes);
  } catch (const std::exception& error) {
    throw std::runtime_error(file + " " + error.what());
  }
}

bool isWanted(DescriptorType type, const std::vector<DescriptorType>& types) {
  return types.empty() || std::find(types.begin(), types.end(), type) != types.end();
}

ObjectModel decodeDescription(const YAML::Node& node) {
  ObjectModel model;
  model.name = node["name"].as<std::string>();
  requireObjectName(model.name);
  model.challenge_id = node["challenge_id"].as<int>();
  model.source = node["source"].as<std::string>();
  model.provenance = node["provenance"].as<std::map<std::string, std::string>>();
  const YAML::Node extents = node["extents"];
  model.extents = {extents["sigma_min"].as<double>(), extents["sigma_max"].as<double>(),
                   extents["sigma_d"].as<double>()};
  requirePlausible(model.extents);
  for (const YAML::Node& plane : node["rest_planes"]) model.rest_planes.push_back(decodeRestPlane(plane));
  return model;
}

}  // namespace

ModelFiles encodeModel(const ObjectModel& model) {
  requireObjectName(model.name);
  try {
    ModelFiles files;
    files[kCloudFile] = encodeCloud(model.cloud);
    for (const auto& [type, features] : model.features) files[featureFile(type)] = encodeFeatures(features, type);
    files[kDescriptionFile] = describe(model, files);
    decodeModel([&](const std::string& file) { return files.at(file); }, {});
    return files;
  } catch (const std::exception& error) {
    throw std::invalid_argument(model.name + ": " + error.what());
  }
}

ObjectModel decodeModel(const std::function<std::string(const std::string& file)>& read,
                        const std::vector<DescriptorType>& types) {
  YAML::Node node;
  ObjectModel model;
  const std::string text = read(kDescriptionFile);
  try {
    node = parseDescription(text);
    model = decodeDescription(node);
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string(kDescriptionFile) + " " + error.what());
  }
  const int version = node["format_version"].as<int>();
  model.cloud = decodeFile(kCloudFile, node["cloud"], read, decodeCloud);
  for (const auto& entry : node["features"]) {
    const DescriptorType type = descriptorFromName(entry.first.as<std::string>());
    if (!isWanted(type, types)) continue;
    model.features[type] = decodeFile(featureFile(type), entry.second, read,
                                      [&](const std::string& pcd) { return decodeFeatures(pcd, type, version); });
  }
  return model;
}

}  // namespace recognition
