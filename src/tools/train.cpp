// train: makes models of objects from textured meshes and from recordings.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>

#include <CLI/CLI.hpp>

#include "progress_bar.h"
#include "recording_training.h"
#include "rgbd_recognition/model/mesh.h"
#include "rgbd_recognition/model/model_builder.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"

namespace rgbd_recognition {
namespace {

/// What config/default.yaml and config/paper.yaml ask for, so that one store serves both.
std::vector<std::string> defaultDescriptors() {
  const std::string ours = descriptorName(FeatureParameters().descriptor),
                    papers = descriptorName(DescriptorType::kSurf128);
  return ours == papers ? std::vector<std::string>{papers} : std::vector<std::string>{papers, ours};
}

struct Options {
  std::string models, mesh, name, bop, config;
  std::vector<int> objects;
  std::vector<std::string> descriptors = defaultDescriptors();
  double unit = 0.0;  // metres; 0: that of the kind of source
  bool overwrite = false;
  TrainingParameters training;
  RecordingOptions recording;
};

struct Job {
  std::string name;
  std::string file;
  int challenge_id = -1;
};

std::vector<Job> listJobs(const Options& options) {
  if (options.recording.given()) return {{options.name, options.recording.source(), -1}};
  if (!options.mesh.empty()) return {{options.name, options.mesh, -1}};
  std::set<int> wanted(options.objects.begin(), options.objects.end());
  std::vector<Job> jobs;
  for (const BopModel& model : listBopModels(options.bop))
    if (options.objects.empty() || wanted.erase(model.id) > 0) jobs.push_back({model.name, model.file, model.id});
  if (!wanted.empty()) throw std::runtime_error(options.bop + ": holds no object " + std::to_string(*wanted.begin()));
  return jobs;
}

std::vector<DescriptorType> listTypes(const Options& options) {
  std::vector<DescriptorType> types;
  for (const std::string& name : options.descriptors) types.push_back(descriptorFromName(name));
  return types;
}

using Provenance = std::map<std::string, std::string>;

void append(Provenance& provenance, const std::string& group, const ParameterList& parameters) {
  for (const Parameter& p : parameters) provenance[group + "/" + p.name] = valueText(p);
}

// What, if the same, makes training again needless.
Provenance provenanceOf(Options options, FeatureParameters features) {
  Provenance provenance;
  if (options.recording.given()) append(provenance, "recording", options.recording.parameters.list());
  else append(provenance, "training", options.training.list());
  for (const Parameter& p : features.list())  // of the extractors alone: the others concern scenes
    if (p.name.rfind("sift_", 0) == 0 || p.name.rfind("surf_", 0) == 0)
      provenance["feature_extraction/" + p.name] = valueText(p);
  std::sort(options.descriptors.begin(), options.descriptors.end());
  for (const std::string& name : options.descriptors)
    provenance["descriptors"] += (provenance["descriptors"].empty() ? "" : " ") + name;
  return provenance;
}

enum class Outcome { kTrained, kUnchanged, kRefused };

class Trainer {
 public:
  explicit Trainer(const Options& options)
      : options_(options),
        features_(options.config.empty() ? FeatureParameters()
                                         : RecognizerParameters::fromYaml(options.config).feature_extraction),
        store_(options.models),
        lock_(store_.lock()) {}

  // Throws with the reason if the object cannot be trained. `summary` is for people.
  Outcome train(const Job& job, std::string& summary) const {
    const auto start = std::chrono::steady_clock::now();
    requireObjectName(job.name);
    Provenance provenance = provenanceOf(options_, features_);
    TexturedMesh mesh;
    if (options_.recording.given()) {
      provenance["recording"] = std::filesystem::absolute(job.file).string();
    } else {
      mesh = readMesh(job.file, unit());
      provenance["mesh_crc32"] = meshChecksum(mesh);
    }
    if (!options_.overwrite && store_.contains(job.name)) {
      summary = "trained already";
      if (isTrainedSo(job.name, provenance)) return Outcome::kUnchanged;
      summary = "is in the store, but trained otherwise or damaged; --overwrite replaces it";
      return Outcome::kRefused;
    }
    std::string remarks;
    ObjectModel model = options_.recording.given()
                            ? buildFromRecording(job.name, remarks)
                            : buildModelFromMesh(mesh, job.name, options_.training, features_, listTypes(options_));
    model.challenge_id = job.challenge_id;
    model.source = std::filesystem::absolute(job.file).string();
    model.provenance = provenance;
    store_.save(model);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    summary = describe(model, seconds.count()) + remarks;
    return Outcome::kTrained;
  }

 private:
  ObjectModel buildFromRecording(const std::string& name, std::string& remarks) const {
    const auto result = trainFromRecording(options_.recording, name, features_, listTypes(options_));
    const TrainingReport& report = result.report;
    char text[160];
    std::snprintf(
        text, sizeof(text), "\n  %d of %d views used, board %.2f px, views agree within %.1f mm, coverage %.0f %%",
        report.views_used, report.views_seen, report.board_rms, 1000.0 * report.residual, 100.0 * report.coverage);
    remarks = text;
    for (const std::string& warning : report.warnings) remarks += "\n  warning: " + warning;
    return result.model;
  }

  double unit() const { return options_.unit > 0.0 ? options_.unit : options_.bop.empty() ? 1.0 : 0.001; }

  bool isTrainedSo(const std::string& name, const Provenance& provenance) const {
    try {
      return store_.load(name).provenance == provenance;
    } catch (const std::runtime_error&) {
      return false;
    }
  }

  static std::string describe(const ObjectModel& model, double seconds) {
    char text[160];
    std::snprintf(text, sizeof(text), "%zu points, sigma %.3f %.3f %.3f m, %.1f s", model.cloud.size(),
                  model.extents.sigma_min, model.extents.sigma_max, model.extents.sigma_d, seconds);
    std::string summary = text;
    for (const auto& [type, features] : model.features)
      summary += ", " + std::to_string(features.count()) + " " + descriptorName(type) + " features";
    return summary;
  }

  const Options& options_;
  FeatureParameters features_;
  ModelStore store_;
  std::shared_ptr<ModelStore::WriteLock> lock_;
};

int run(const Options& options) {
  const std::vector<Job> jobs = listJobs(options);
  const Trainer trainer(options);
  const bool terminal = isatty(STDERR_FILENO) == 1;
  std::vector<std::string> lines;
  int failures = 0;
  {
    ProgressBar progress("training", static_cast<int>(jobs.size()));
    for (const Job& job : jobs) {
      std::string summary;
      try {
        if (trainer.train(job, summary) == Outcome::kRefused) ++failures;
      } catch (const std::exception& error) {
        std::string reason = error.what();
        if (reason.rfind(job.name + ": ", 0) == 0) reason.erase(0, job.name.size() + 2);
        summary = "not trained: " + reason;
        ++failures;
      }
      lines.push_back(job.name + ": " + summary);
      if (!terminal) std::printf("%s\n", lines.back().c_str()), std::fflush(stdout);
      progress.advance(job.name);
    }
  }
  if (terminal)
    for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  return failures == 0 ? 0 : 1;
}

void addParameters(CLI::App& app, const ParameterList& parameters, const std::string& group, const std::string& title) {
  for (const Parameter& parameter : parameters) {
    std::string name = parameter.name;
    std::replace(name.begin(), name.end(), '_', '-');
    const std::string doc =
        parameter.doc + (parameter.unit.empty() ? "" : ", " + parameter.unit) + " [" + valueText(parameter) + "]";
    const auto set = [parameter, group](const std::string& text) { setFromText(parameter, text, group); };
    app.add_option_function<std::string>("--" + name, set, doc)->group(title);
  }
}

// Those that mesh training has too get a name of their own.
ParameterList recordingParameters(RecordingParameters& recording) {
  ParameterList list = recording.list();
  TrainingParameters training;
  for (Parameter& parameter : list)
    for (const Parameter& other : training.list())
      if (parameter.name == other.name) {
        parameter.name = "recording_" + parameter.name;
        break;
      }
  return list;
}

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Trains models of objects from textured meshes (PLY, OBJ), turntable recordings, or one labelled view, and puts "
      "them into a model store.");
  app.footer(
      "Objects that the store has already, trained from the same mesh with the same parameters, are skipped: an "
      "interrupted run goes on where it "
      "stopped.\nExit code: 0 if all objects are in the store, 1 if one could not be trained, 2 if none was tried, "
      "above 100 for wrong arguments.");
  app.add_option("--models", options.models, "model store, a directory; made if need be")->required();
  auto* mesh = app.add_option("--mesh", options.mesh, "mesh of one object")->check(CLI::ExistingFile);
  auto* name = app.add_option("--name", options.name, "its name");
  auto* bop = app.add_option("--bop", options.bop, "BOP models folder; trains every object in it")
                  ->check(CLI::ExistingDirectory);
  app.add_option("--objects", options.objects, "with --bop: only these ids, as in 1,2,5")->delimiter(',')->needs(bop);
  app.add_option("--unit", options.unit, "length of the mesh's unit in metres [1 with --mesh, 0.001 with --bop]")
      ->check(CLI::PositiveNumber);
  app.add_option("--descriptors", options.descriptors, "feature types: sift, surf128, surf64")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--config", options.config, "parameters of feature extraction, config/*.yaml")
      ->check(CLI::ExistingFile);
  app.add_flag("--overwrite", options.overwrite, "train also what the store has");
  addRecordingOptions(app, options.recording, name);
  addParameters(app, options.training.list(), "training", "Training from meshes");
  addParameters(app, recordingParameters(options.recording.parameters), "recording", "Training from recordings");
  mesh->needs(name)->excludes(bop);
  name->excludes(bop);
  try {
    app.parse(argc, argv);
    if (options.mesh.empty() && options.bop.empty() && !options.recording.given())
      throw CLI::RequiredError("--mesh, --bop, --bag, --frames or --color");
    return run(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "train: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace rgbd_recognition

int main(int argc, char** argv) { return rgbd_recognition::main(argc, argv); }
