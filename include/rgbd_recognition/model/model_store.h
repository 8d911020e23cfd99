#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// A directory of models, one sub-directory an object: model.yaml, cloud.pcd, features_<type>.pcd (design: every file opens with a common tool).
/// Written to a temporary name, synced, renamed: a crash never leaves half a model.
class ModelStore {
 public:
  explicit ModelStore(std::string directory);

  struct LoadResult {
    std::shared_ptr<const ModelDatabase> database;  ///< models in order of name
    std::vector<std::string> errors;                ///< one line a model that was skipped: which, and why
  };

  /// Loads all models; damaged or newer ones are skipped and named. Throws std::runtime_error if the directory cannot be read.
  LoadResult loadAll() const;

  ObjectModel load(const std::string& name) const;
  /// Adds or replaces one model. Throws std::runtime_error (disk) or std::invalid_argument (name).
  void save(const ObjectModel& model) const;
  void remove(const std::string& name) const;
  std::vector<std::string> names() const;

 private:
  std::string directory_;
};

}  // namespace rgbd_recognition
