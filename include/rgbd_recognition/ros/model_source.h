#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

/// The models of one store as they are in memory.
struct LoadedModels {
  std::shared_ptr<const ModelDatabase> database;
  std::vector<std::string> errors;  ///< one line a model that was skipped
};

/// A store loaded once a process and shared by all nodelets that name it. reload() swaps the models; whoever holds the
/// earlier ones keeps them.
class ModelSource {
 public:
  /// The process's source of `directory`, loaded by the first caller while others wait. Throws std::runtime_error if it
  /// cannot be read.
  static std::shared_ptr<ModelSource> open(const std::string& directory);

  std::shared_ptr<const LoadedModels> current() const;

  /// Loads the store anew; the present models stay if that throws (std::runtime_error).
  void reload();

  const std::string& directory() const { return directory_; }

 private:
  explicit ModelSource(const std::string& directory);

  const std::string directory_;
  mutable std::mutex mutex_;  // guards the pointer only, never held while loading
  std::shared_ptr<const LoadedModels> models_;
};

}  // namespace rgbd_recognition
