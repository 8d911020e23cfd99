#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// The models of one store as they are in memory.
struct LoadedModels {
  std::shared_ptr<const ModelDatabase> database;
  std::vector<std::string> errors;  ///< one line a model that was skipped
  ModelStore::Stamps stamps;        ///< of the models when they were read
  std::uint64_t revision = 0;       ///< of the store: the same in all processes that read it in the same state
};

/// A store loaded once a process and shared by all nodelets that name it. A thread looks at the store a few times a
/// second; when a model was added, replaced or removed, it reads that one, lets the stages prepare for it, and swaps
/// the models. Whoever holds the earlier ones keeps them.
class ModelSource {
 public:
  /// The process's source of `directory`, loaded by the first caller while others wait. Throws std::runtime_error if it
  /// cannot be read.
  static std::shared_ptr<ModelSource> open(const std::string& directory);
  ~ModelSource();

  std::shared_ptr<const LoadedModels> current() const;
  /// The current models or those before, whichever have that revision; the current ones if neither has.
  std::shared_ptr<const LoadedModels> atRevision(std::uint64_t revision) const;

  /// Reads what changed in the store, at once; the present models stay if that throws (std::runtime_error).
  void reload();

  /// `prepare` is called with new models before they become the current ones, from whichever thread loads them, so that
  /// no frame waits for what a stage makes of them. It lasts as long as the returned handle, which must not be dropped
  /// from inside of it.
  using Preparation = std::function<void(const std::shared_ptr<const ModelDatabase>&)>;
  std::shared_ptr<void> beforeSwap(const Preparation& prepare);

  const std::string& directory() const { return store_.directory(); }

 private:
  explicit ModelSource(const std::string& directory);
  void watch();

  const ModelStore store_;
  mutable std::mutex mutex_;  // guards the two pointers only, never held while loading
  std::shared_ptr<const LoadedModels> models_;
  std::shared_ptr<const LoadedModels> models_before_;

  std::mutex loading_;  // held while loading and preparing; guards the preparations
  std::map<int, Preparation> preparations_;
  int next_preparation_ = 0;

  std::mutex stop_mutex_;  // guards stop_
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread watcher_;
};

}  // namespace recognition
