#include <map>
#include <stdexcept>
#include <string>

#include <yaml-cpp/yaml.h>

#include "rgbd_recognition/recognizer.h"

namespace recognition {
namespace {

/// For names of earlier versions: what to write instead.
std::string newNameOf(const std::string& name) {
  static const std::map<std::string, std::string> kRenamed = {{"suggestions", "correspondence_proposals"},
                                                              {"shape_suggestions", "resting_proposals"},
                                                              {"light_compensation", "illumination_compensation"},
                                                              {"budget_ms", "work_limit_ms"}};
  const auto found = kRenamed.find(name);
  return found == kRenamed.end() ? "" : "; it is called " + found->second + " now";
}

void readGroup(const YAML::Node& group_node, const std::string& group, const ParameterList& parameters) {
  if (!group_node.IsMap()) throw std::invalid_argument(group + " is no map of parameters");
  for (const auto& entry : group_node) {
    const std::string name = entry.first.as<std::string>();
    const Parameter* found = nullptr;
    for (const Parameter& p : parameters)
      if (p.name == name) found = &p;
    if (!found) throw std::invalid_argument(group + "/" + name + " is no known parameter" + newNameOf(name));
    if (!entry.second.IsScalar()) throw std::invalid_argument(group + "/" + name + " is no single value");
    setFromText(*found, entry.second.Scalar(), group);
  }
}

}  // namespace

std::vector<std::pair<std::string, ParameterList>> RecognizerParameters::groups() {
  return {{"segmentation", segmentation.list()},
          {"feature_extraction", feature_extraction.list()},
          {"hypothesis_generation", hypothesis_generation.list()},
          {"reprojection_verification", reprojection_verification.list()}};
}

void RecognizerParameters::validate() const {
  segmentation.validate();
  feature_extraction.validate();
  hypothesis_generation.validate();
  reprojection_verification.validate();
}

RecognizerParameters RecognizerParameters::fromYaml(const std::string& file) {
  RecognizerParameters parameters;
  try {
    const auto groups = parameters.groups();
    for (const auto& entry : YAML::LoadFile(file)) {
      const std::string name = entry.first.as<std::string>();
      const ParameterList* list = nullptr;
      for (const auto& group : groups)
        if (group.first == name) list = &group.second;
      if (!list) throw std::invalid_argument(name + " is no group of parameters");
      readGroup(entry.second, name, *list);
    }
    parameters.validate();
  } catch (const std::exception& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
  return parameters;
}

}  // namespace recognition
