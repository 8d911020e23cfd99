#include "ros/model_source.h"

#include <ros/console.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>

namespace recognition {
namespace {

constexpr std::chrono::milliseconds kWatchInterval(300);

std::uint64_t revisionOf(const ModelStore::Stamps& stamps) {
  std::uint64_t hash = 14695981039346656037u;
  for (const auto& [name, stamp] : stamps) {
    for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211u;
    hash = (hash ^ stamp) * 1099511628211u;
  }
  return hash;
}

// All models of the store; those of `before` whose stamp is the same are not read again.
std::shared_ptr<const LoadedModels> loadModels(const ModelStore& store, const LoadedModels& before) {
  auto models = std::make_shared<LoadedModels>();
  models->stamps = store.stamps();  // before reading: what changes while it is read is read once more
  models->revision = revisionOf(models->stamps);
  auto database = std::make_shared<ModelDatabase>();
  for (const auto& [name, stamp] : models->stamps) {
    const auto known = before.stamps.find(name);
    const int index = before.database->find(name);
    if (index >= 0 && known != before.stamps.end() && known->second == stamp) {
      database->objects.push_back(before.database->objects[static_cast<size_t>(index)]);
      continue;
    }
    try {
      database->objects.push_back(std::make_shared<ObjectModel>(store.load(name)));
    } catch (const std::exception& error) {
      if (store.contains(name)) models->errors.emplace_back(error.what());
    }
  }
  models->database = database;
  return models;
}

std::shared_ptr<const LoadedModels> loadModels(const ModelStore& store) {
  auto models = std::make_shared<LoadedModels>();
  models->stamps = store.stamps();
  models->revision = revisionOf(models->stamps);
  const ModelStore::LoadResult result = store.loadAll();
  models->database = result.database;
  models->errors = result.errors;
  return models;
}

// Once a process, not once a stage.
void tell(const LoadedModels& models, const std::string& directory) {
  for (const std::string& error : models.errors) ROS_ERROR("model skipped: %s", error.c_str());
  if (models.database->objects.empty())
    ROS_ERROR("%s holds no models: nothing will be recognised", directory.c_str());
  else
    ROS_INFO("%zu models of %s", models.database->objects.size(), directory.c_str());
}

}  // namespace

std::shared_ptr<ModelSource> ModelSource::open(const std::string& directory) {
  static std::mutex mutex;  // held while loading, so that the second caller waits for the first one's models
  static std::map<std::string, std::weak_ptr<ModelSource>> sources;
  const std::lock_guard<std::mutex> lock(mutex);
  if (auto source = sources[directory].lock()) return source;
  const std::shared_ptr<ModelSource> source(new ModelSource(directory));
  sources[directory] = source;
  tell(*source->current(), directory);
  return source;
}

ModelSource::ModelSource(const std::string& directory)
    : store_(directory), models_(loadModels(store_)), models_before_(models_), watcher_([this] { watch(); }) {}

ModelSource::~ModelSource() {
  {
    const std::lock_guard<std::mutex> lock(stop_mutex_);
    stop_ = true;
  }
  stopped_.notify_all();
  watcher_.join();
}

std::shared_ptr<const LoadedModels> ModelSource::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return models_;
}

std::shared_ptr<const LoadedModels> ModelSource::atRevision(std::uint64_t revision) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return models_before_->revision == revision ? models_before_ : models_;
}

void ModelSource::reload() {
  const std::lock_guard<std::mutex> loading(loading_);
  const auto before = current();
  if (!std::filesystem::is_directory(directory()))
    throw std::runtime_error(directory() + ": is no model store (no such directory)");
  auto models = loadModels(store_, *before);
  if (models->revision == before->revision) return;
  for (const auto& preparation : preparations_) preparation.second(models->database);
  tell(*models, directory());
  const std::lock_guard<std::mutex> lock(mutex_);
  models_before_ = models_;
  models_ = models;
}

std::shared_ptr<void> ModelSource::beforeSwap(const Preparation& prepare) {
  const std::lock_guard<std::mutex> loading(loading_);
  const int id = next_preparation_++;
  preparations_[id] = prepare;
  return std::shared_ptr<void>(nullptr, [this, id](void*) {
    const std::lock_guard<std::mutex> lock(loading_);  // waits for a preparation in work
    preparations_.erase(id);
  });
}

void ModelSource::watch() {
  std::unique_lock<std::mutex> lock(stop_mutex_);
  std::uint64_t tried = current()->revision;
  while (!stopped_.wait_for(lock, kWatchInterval, [this] { return stop_; })) {
    try {
      const std::uint64_t revision = std::filesystem::is_directory(directory()) ? revisionOf(store_.stamps()) : tried;
      if (revision == tried) continue;
      tried = revision;  // what fails is not tried again until the store changes once more
      reload();
    } catch (const std::exception& error) {
      ROS_ERROR("models are not read anew: %s", error.what());
    }
  }
}

}  // namespace recognition
