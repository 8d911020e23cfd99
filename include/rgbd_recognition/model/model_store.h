#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// Throws std::invalid_argument unless `name` may name an object: 1 to 100 letters, digits, '_', '-' or '.', no '.' in
/// front.
void requireObjectName(const std::string& name);

/// A directory of models. Each object has a sub-directory with model.yaml, cloud.pcd and features_<type>.pcd, which
/// common tools open. Descriptors are stored as 8-bit integers. The directory may be copied, and models may be removed
/// from it, by hand.
///
/// A writer writes to a temporary name, syncs and exchanges, so that a crash never leaves half a model and readers
/// never see one. A second writer is refused. Reading needs no lock. Several threads may read through one ModelStore;
/// only one may write.
class ModelStore {
 public:
  explicit ModelStore(std::string directory);

  struct LoadResult {
    std::shared_ptr<const ModelDatabase> database;  ///< models in order of name
    std::vector<std::string> errors;                ///< one line a model that was skipped: which, and why
  };

  /// Loads all models; damaged or newer ones are skipped and named. Only features of `types` are loaded (empty: of all
  /// types). Throws std::runtime_error if the directory cannot be read.
  LoadResult loadAll(const std::vector<DescriptorType>& types = {}) const;

  /// Throws std::runtime_error naming the model and what is missing or damaged.
  ObjectModel load(const std::string& name, const std::vector<DescriptorType>& types = {}) const;

  /// Adds or replaces one model; makes the directory if need be. Throws std::runtime_error (disk, another writer) or
  /// std::invalid_argument (name, or a model that could not be read back: values not finite, descriptors that do not
  /// fit).
  void save(const ObjectModel& model) const;
  /// Throws std::runtime_error if there is no such model.
  void remove(const std::string& name) const;
  void rename(const std::string& from, const std::string& to) const;

  /// Writes one model to one file, a tar archive of its directory.
  void exportModel(const std::string& name, const std::string& file) const;
  /// Adds the model of such a file, which keeps its name, and returns that. Throws std::runtime_error naming the file
  /// for anything that is no whole model, and if there is a model of that name already.
  std::string importModel(const std::string& file) const;

  /// Names of all models, damaged ones too, in order. Empty if the directory does not exist.
  std::vector<std::string> names() const;
  bool contains(const std::string& name) const;

  /// A number of each model that changes when the model is replaced. No file is read, so a program may ask often
  /// whether the store changed.
  using Stamps = std::map<std::string, std::uint64_t>;
  Stamps stamps() const;

  const std::string& directory() const { return directory_; }

  /// The right to write. Each writing call takes it for itself. Whoever holds it keeps other writers out for longer,
  /// e.g. during a long training.
  class WriteLock;
  /// Throws std::runtime_error if another writer holds it.
  std::shared_ptr<WriteLock> lock() const;

 private:
  std::string pathOf(const std::string& name) const;

  std::string directory_;
  mutable std::weak_ptr<WriteLock> lock_;
};

}  // namespace recognition
