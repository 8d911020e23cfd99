#include "tools/store_commands.h"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <stdexcept>

#include "rgbd_recognition/training/object_trainer.h"

namespace recognition {
namespace {

// Damaged models too, with what is wrong; their number.
int printModels(const ModelStore& store) {
  int damaged = 0;
  for (const std::string& name : store.names()) {
    try {
      const ObjectModel model = store.load(name);
      std::printf("%s: %s\n  from %s\n", name.c_str(), describe(model).c_str(), model.source.c_str());
    } catch (const std::exception& error) {
      std::printf("%s\n", error.what());
      ++damaged;
    }
  }
  return damaged;
}

}  // namespace

void StoreCommands::addTo(CLI::App& app) {
  const char* group = "Keeping the store";
  app.add_flag("--list", list, "the models, and what is wrong with damaged ones")->group(group);
  app.add_option("--remove", remove, "models by name")->delimiter(',')->group(group);
  app.add_option("--rename", rename, "OLD NEW")->expected(2)->group(group);
  app.add_option("--export", export_model, "NAME FILE: one model as one file, a tar archive")
      ->expected(2)
      ->group(group);
  app.add_option("--import", import_models, "files that --export wrote")->check(CLI::ExistingFile)->group(group);
}

int StoreCommands::run(const ModelStore& store) const {
  for (const std::string& file : import_models) std::printf("%s: imported\n", store.importModel(file).c_str());
  if (!rename.empty()) store.rename(rename[0], rename[1]);
  if (!export_model.empty()) store.exportModel(export_model[0], export_model[1]);
  for (const std::string& name : remove) store.remove(name);
  return list && printModels(store) > 0 ? 1 : 0;
}

std::map<std::string, int> readChallengeIds(const std::string& file) {
  try {
    return YAML::LoadFile(file).as<std::map<std::string, int>>();
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(file + ": is no yaml of name: id (" + error.what() + ")");
  }
}

}  // namespace recognition
