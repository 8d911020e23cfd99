#include "rgbd_recognition/model/model_store.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <stdexcept>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "model/durable_file.h"
#include "model/model_files.h"
#include "model/tar.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLongestName = 100;
constexpr std::uint64_t kMaxFile = std::uint64_t(1) << 30;  // bytes
constexpr int kReadAttempts = 5;                            // while a writer replaces the model under the reader
constexpr const char* kTemporary = ".tmp-";                 // a model being written
constexpr const char* kDisplaced =
    ".old-";  // a model being replaced, where the file system cannot exchange two directories

bool startsWith(const std::string& text, const char* prefix) { return text.rfind(prefix, 0) == 0; }

// Identifies the directory behind a path: changes when a writer replaces it.
ino_t identityOf(const std::string& path) {
  struct stat status;
  return stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

// FNV-1a over what changes whenever the file is written anew, or replaced by another.
std::uint64_t stampOfFile(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return 0;
  std::uint64_t hash = 14695981039346656037u;
  for (const auto part :
       {static_cast<std::uint64_t>(status.st_ino), static_cast<std::uint64_t>(status.st_size),
        static_cast<std::uint64_t>(status.st_mtim.tv_sec), static_cast<std::uint64_t>(status.st_mtim.tv_nsec)})
    hash = (hash ^ part) * 1099511628211u;
  return hash;
}

// Over all files of a model, in whatever order the system lists them.
std::uint64_t stampOfModel(const std::string& path) {
  std::error_code gone;  // by a writer, meanwhile
  std::uint64_t sum = 0;
  for (fs::directory_iterator entry(path, gone), end; !gone && entry != end; entry.increment(gone))
    sum += stampOfFile(entry->path().string());
  return sum;
}

// What earlier writers left when they were killed.
void cleanUp(const std::string& directory) {
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (startsWith(name, kDisplaced)) {
      const fs::path original = fs::path(directory) / name.substr(std::strlen(kDisplaced));
      if (!fs::exists(original))
        fs::rename(entry.path(), original);
      else
        fs::remove_all(entry.path());
    } else if (startsWith(name, kTemporary)) {
      fs::remove_all(entry.path());
    }
  }
}

}  // namespace

void requireObjectName(const std::string& name) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.'; };
  if (name.empty() || name.size() > kLongestName)
    throw std::invalid_argument("an object's name has 1 to 100 characters, this one has " +
                                std::to_string(name.size()));
  if (name.front() == '.' || !std::all_of(name.begin(), name.end(), allowed))
    throw std::invalid_argument("object name '" + name +
                                "' has other than letters, digits, '_', '-', '.', or a '.' in front");
}

class ModelStore::WriteLock {
 public:
  explicit WriteLock(const std::string& directory) {
    fs::create_directories(directory);
    const std::string path = directory + "/.lock";
    fd_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd_ < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      close(fd_);
      throw std::runtime_error(directory + ": another program is writing to this model store");
    }
    cleanUp(directory);
  }
  ~WriteLock() { close(fd_); }
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;

 private:
  int fd_ = -1;
};

ModelStore::ModelStore(std::string directory) : directory_(std::move(directory)) {
  if (directory_.empty()) throw std::invalid_argument("the model store's directory is empty");
}

std::string ModelStore::pathOf(const std::string& name) const { return directory_ + "/" + name; }

std::shared_ptr<ModelStore::WriteLock> ModelStore::lock() const {
  std::shared_ptr<WriteLock> held = lock_.lock();
  if (!held) lock_ = held = std::make_shared<WriteLock>(directory_);
  return held;
}

std::vector<std::string> ModelStore::names() const {
  std::vector<std::string> names;
  if (!fs::exists(directory_)) return names;
  for (const auto& entry : fs::directory_iterator(directory_)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && name.front() != '.') names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

ModelStore::Stamps ModelStore::stamps() const {
  Stamps stamps;
  for (const std::string& name : names()) stamps[name] = stampOfModel(pathOf(name));
  return stamps;
}

bool ModelStore::contains(const std::string& name) const {
  requireObjectName(name);
  return fs::is_directory(pathOf(name));
}

ObjectModel ModelStore::load(const std::string& name, const std::vector<DescriptorType>& types) const {
  if (!contains(name)) throw std::runtime_error(name + ": there is no such model in " + directory_);
  for (int attempt = 1;; ++attempt) {
    const ino_t before = identityOf(pathOf(name));
    try {
      ObjectModel model =
          decodeModel([&](const std::string& file) { return readWhole(pathOf(name) + "/" + file, kMaxFile); }, types);
      if (model.name != name) throw std::runtime_error("holds the model of another object, " + model.name);
      return model;
    } catch (const std::exception& error) {
      if (identityOf(pathOf(name)) == before || attempt == kReadAttempts)
        throw std::runtime_error(name + ": " + error.what());
    }
  }
}

ModelStore::LoadResult ModelStore::loadAll(const std::vector<DescriptorType>& types) const {
  if (!fs::is_directory(directory_)) throw std::runtime_error(directory_ + ": is no model store (no such directory)");
  const std::vector<std::string> all = names();
  std::vector<std::shared_ptr<const ObjectModel>> models(all.size());
  std::vector<std::string> errors(all.size());
  cv::parallel_for_(cv::Range(0, static_cast<int>(all.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i) {
      try {
        models[i] = std::make_shared<ObjectModel>(load(all[i], types));
      } catch (const std::exception& error) {
        errors[i] = error.what();
      }
    }
  });
  auto database = std::make_shared<ModelDatabase>();
  LoadResult result;
  for (size_t i = 0; i < all.size(); ++i) {
    if (models[i])
      database->objects.push_back(models[i]);
    else
      result.errors.push_back(errors[i]);
  }
  result.database = database;
  return result;
}

void ModelStore::save(const ObjectModel& model) const {
  const ModelFiles files = encodeModel(model);
  const auto held = lock();
  const std::string temporary = pathOf(kTemporary + model.name);
  const std::string displaced = pathOf(kDisplaced + model.name);
  try {
    fs::create_directory(temporary);
    for (const auto& [file, bytes] : files) writeDurably(temporary + "/" + file, bytes);
    syncDirectory(temporary);
    putDirectoryInPlace(temporary, pathOf(model.name), displaced);
    syncDirectory(directory_);
  } catch (const std::exception&) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    throw;
  }
  fs::remove_all(temporary);
  fs::remove_all(displaced);
}

void ModelStore::remove(const std::string& name) const {
  if (!contains(name)) throw std::runtime_error(name + ": there is no such model in " + directory_);
  const auto held = lock();
  const std::string temporary = pathOf(kTemporary + name);
  fs::rename(pathOf(name), temporary);
  syncDirectory(directory_);
  fs::remove_all(temporary);
}

void ModelStore::rename(const std::string& from, const std::string& to) const {
  const auto held = lock();
  if (contains(to)) throw std::runtime_error(to + ": there is such a model in " + directory_ + " already");
  ObjectModel model = load(from);
  model.name = to;
  save(model);
  remove(from);
}

void ModelStore::exportModel(const std::string& name, const std::string& file) const {
  writeDurably(file, encodeTar(name, encodeModel(load(name))));
}

std::string ModelStore::importModel(const std::string& file) const {
  ObjectModel model;
  try {
    const ModelFiles files = decodeTar(readWhole(file, kMaxFile));
    const auto read = [&files](const std::string& name) {
      if (files.count(name) == 0) throw std::runtime_error("holds no " + name);
      return files.at(name);
    };
    model = decodeModel(read, {});
  } catch (const std::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
  const auto held = lock();
  if (contains(model.name))
    throw std::runtime_error(model.name + ": there is such a model in " + directory_ + " already");
  save(model);
  return model.name;
}

}  // namespace recognition
