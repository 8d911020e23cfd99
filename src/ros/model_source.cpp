#include "rgbd_recognition/ros/model_source.h"

#include <map>

#include "rgbd_recognition/model/model_store.h"

namespace rgbd_recognition {
namespace {

std::shared_ptr<const LoadedModels> loadModels(const std::string& directory) {
  const ModelStore::LoadResult result = ModelStore(directory).loadAll();
  return std::make_shared<LoadedModels>(LoadedModels{result.database, result.errors});
}

}  // namespace

std::shared_ptr<ModelSource> ModelSource::open(const std::string& directory) {
  static std::mutex mutex;  // held while loading, so that the second caller waits for the first one's models
  static std::map<std::string, std::weak_ptr<ModelSource>> sources;
  const std::lock_guard<std::mutex> lock(mutex);
  if (auto source = sources[directory].lock()) return source;
  const std::shared_ptr<ModelSource> source(new ModelSource(directory));
  sources[directory] = source;
  return source;
}

ModelSource::ModelSource(const std::string& directory) : directory_(directory), models_(loadModels(directory)) {}

std::shared_ptr<const LoadedModels> ModelSource::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return models_;
}

void ModelSource::reload() {
  auto models = loadModels(directory_);
  const std::lock_guard<std::mutex> lock(mutex_);
  models_.swap(models);
}

}  // namespace rgbd_recognition
