#include "ros/shared_models.h"

#include <mutex>
#include <vector>

namespace recognition {
namespace {

struct Shared {
  std::weak_ptr<const ModelDatabase> database;
  std::weak_ptr<const PreparedModels> prepared;
};

}  // namespace

std::shared_ptr<const PreparedModels> sharedPreparedModels(const std::shared_ptr<const ModelDatabase>& database) {
  static std::mutex mutex;  // guards the list; held while models are made, so that they are made once
  static std::vector<Shared> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::vector<Shared> alive;
  for (const Shared& one : all) {
    const auto prepared = one.prepared.lock();
    if (!prepared) continue;
    if (one.database.lock() == database) return prepared;
    alive.push_back(one);
  }
  auto prepared = std::make_shared<const PreparedModels>(*database);
  prepared->prepareAll();
  alive.push_back({database, prepared});
  all.swap(alive);
  return prepared;
}

}  // namespace recognition
