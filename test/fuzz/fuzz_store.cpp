// One file of a good model replaced by the input, or a whole archive; the first byte chooses which.
#include <algorithm>

#include "fuzz/fuzz.h"
#include "model/random_model.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

std::vector<std::string> filesOf(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

ObjectModel smallModel() {
  ObjectModel model = randomModel("model");
  model.cloud.resize(20);
  cv::RNG rng(1);
  for (auto& [type, features] : model.features) features = randomFeatures(type, 3, rng);
  return model;
}

const ModelStore& store() {
  static const ModelStore instance(fuzzFolder() / "store");
  return instance;
}

/// The files of the good model.
const std::vector<std::string>& files() {
  static const std::vector<std::string> names = [] {
    store().save(smallModel());
    return filesOf(store().directory() + "/model");
  }();
  return names;
}

}  // namespace
}  // namespace recognition

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace recognition;
  for (size_t i = 0; i < files().size(); ++i)
    writeSeed("file" + std::to_string(i), static_cast<char>(i) + readText(files()[i]));
  const std::string archive = fuzzFolder() / "seed.tar";
  store().exportModel("model", archive);
  writeSeed("archive", static_cast<char>(files().size()) + readText(archive));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  static const ModelStore imported(fuzzFolder() / "imported");
  if (size == 0) return 0;
  const size_t choice = data[0] % (files().size() + 1);
  if (choice == files().size()) {
    const std::string archive = inputFile("model.tar", data + 1, size - 1);
    mayRefuse([&] { imported.remove(imported.importModel(archive)); });
    return 0;
  }
  const std::string good = readText(files()[choice]);
  writeText(files()[choice], std::string(data + 1, data + size));
  mayRefuse([&] { store().load("model"); });
  store().loadAll();
  writeText(files()[choice], good);
  return 0;
}
