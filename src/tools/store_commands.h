#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "rgbd_recognition/model/model_store.h"

namespace recognition {

/// What `train` does with a store beside training.
struct StoreCommands {
  bool list = false;
  std::vector<std::string> remove, rename, export_model, import_models;

  void addTo(CLI::App& app);
  bool given() const {
    return list || !remove.empty() || !rename.empty() || !export_model.empty() || !import_models.empty();
  }
  /// Exit code. Throws std::runtime_error or std::invalid_argument with the reason.
  int run(const ModelStore& store) const;
};

/// The challenge's ids by object name, from a yaml file of `name: id`. Throws std::runtime_error naming file and value.
std::map<std::string, int> readChallengeIds(const std::string& file);

}  // namespace recognition
