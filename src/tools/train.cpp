// train: makes models of objects from textured meshes and from recordings.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "core/shard.h"
#include "tools/progress_bar.h"
#include "tools/recording_training.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/recognizer.h"
#include "rgbd_recognition/training/object_trainer.h"
#include "tools/silence.h"
#include "tools/store_commands.h"

namespace recognition {
namespace {

std::vector<std::string> defaultDescriptors() {
  std::vector<std::string> names;
  for (const DescriptorType type : defaultDescriptorTypes()) names.emplace_back(descriptorName(type));
  return names;
}

struct Options {
  std::string models, mesh, name, bop, config, challenge_ids, shard = "1/1";
  std::vector<int> objects;
  std::vector<std::string> descriptors = defaultDescriptors();
  double unit = 0.0;  // metres; 0: that of the kind of source
  int id = -1;
  bool overwrite = false, extend = false, turned_over = false, untextured = false, no_self_test = false;
  TrainingSettings settings;
  RecordingOptions recording;
  StoreCommands commands;
};

struct Job {
  std::string name;
  std::string file;
  int challenge_id = -1;
};

std::vector<Job> listMeshes(const Options& options) {
  if (!options.mesh.empty()) return {{options.name, options.mesh, options.id}};
  std::set<int> wanted(options.objects.begin(), options.objects.end());
  std::vector<Job> jobs;
  for (const BopModel& model : listBopModels(options.bop)) {
    if (!options.objects.empty() && wanted.erase(model.id) == 0) continue;
    jobs.push_back({model.name, model.file, model.id});
    if (!model.given_name.empty())
      std::fprintf(stderr, "train: object %d, \"%s\", is called %s in the store\n", model.id, model.given_name.c_str(),
                   model.name.c_str());
  }
  if (!wanted.empty()) throw std::runtime_error(options.bop + ": holds no object " + std::to_string(*wanted.begin()));
  return jobs;
}

std::vector<Job> listJobs(const Options& options) {
  std::vector<Job> jobs;
  if (!options.recording.given())
    jobs = listMeshes(options);
  else
    for (const auto& [name, file] : listRecordings(options.recording, options.name))
      jobs.push_back({name, file, options.id});
  const Shard shard = Shard::parse(options.shard);
  size_t item = 0;
  jobs.erase(std::remove_if(jobs.begin(), jobs.end(), [&](const Job&) { return !shard.takes(item++); }), jobs.end());
  if (options.challenge_ids.empty()) return jobs;
  const auto ids = readChallengeIds(options.challenge_ids);
  for (Job& job : jobs)
    if (const auto id = ids.find(job.name); id != ids.end()) job.challenge_id = id->second;
  return jobs;
}

TrainingSettings settingsOf(const Options& options) {
  TrainingSettings settings = options.settings;
  if (!options.config.empty()) settings.features = RecognizerParameters::fromYaml(options.config).feature_extraction;
  settings.types.clear();
  for (const std::string& name : options.descriptors) settings.types.push_back(descriptorFromName(name));
  return settings;
}

// A bar over the views of a recording, then over what else an object takes.
class Bars : public TrainingListener {
 public:
  explicit Bars(int views) : reading_("reading", views) {}
  void viewTaken(const RecordedObject& object, const RecordedView&, const std::string&) override {
    reading_.advance(std::to_string(object.views()) + " used");
  }

 private:
  ProgressBar reading_;
};

// How far one mesh is, within the bar over all of them.
class MeshProgress : public TrainingListener {
 public:
  MeshProgress(ProgressBar& bar, const std::string& name) : bar_(bar), name_(name) {}
  void progress(const std::string& stage, double done) override { bar_.within(done, name_ + ": " + stage); }

 private:
  ProgressBar& bar_;
  const std::string name_;
};

std::string describe(const TrainingReport& report) {
  char text[160], board[40] = "";
  if (report.board_rms > 0.0) std::snprintf(board, sizeof(board), ", board %.2f px", report.board_rms);
  std::snprintf(text, sizeof(text), "\n  %d of %d views used%s, views agree within %.1f mm, coverage %.0f %%",
                report.views_used, report.views_seen, board, 1000.0 * report.residual, 100.0 * report.coverage);
  std::string lines = text;
  for (const std::string& warning : report.warnings) lines += "\n  warning: " + warning;
  return lines;
}

// What a recording's poses are from, beside its board.
std::string posesOf(const RecordingOptions& options) {
  if (!options.object_frame.empty()) return ", poses of tf frame " + options.object_frame;
  return options.object_id ? ", poses of object " + std::to_string(*options.object_id) : "";
}

ExistingModel existingModel(const Options& options) {
  if (options.turned_over) return ExistingModel::kExtendTurnedOver;
  if (options.extend) return ExistingModel::kExtend;
  return options.overwrite ? ExistingModel::kReplace : ExistingModel::kKeep;
}

TrainingOutcome trainMesh(const Options& options, const Job& job, const TrainingTask& task, ObjectTrainer& trainer,
                          ProgressBar& bar) {
  MeshProgress progress(bar, job.name);
  const bool is_bop = !options.bop.empty();
  const double unit = options.unit > 0.0 ? options.unit : is_bop ? 0.001 : 1.0;
  MeshOptions mesh;
  mesh.unit_is_sure = options.unit > 0.0;
  mesh.untextured = options.untextured;
  mesh.self_test = !options.no_self_test && !options.untextured;
  return trainer.trainFromMesh(task, job.file, unit, progress, mesh);
}

TrainingOutcome trainOne(const Options& options, const Job& job, ObjectTrainer& trainer, ProgressBar& bar) {
  const TrainingTask task{job.name, job.challenge_id,
                          std::filesystem::absolute(job.file).string() + posesOf(options.recording),
                          existingModel(options), readWorldFromObject(options.recording)};
  if (!options.recording.given()) return trainMesh(options, job, task, trainer, bar);
  requireObjectName(job.name);
  const auto source = openRecording(options.recording, job.file);
  Bars bars(source->size());
  TrainingOutcome outcome =
      trainer.trainFromViews(task, readBoard(options.recording), viewsOf(*source, options.recording), bars);
  if (const std::string remarks = source->remarks(); !remarks.empty()) outcome.report.warnings.push_back(remarks);
  return outcome;
}

// One line for people, more for recordings; false if there is no model.
bool train(const Options& options, const Job& job, ObjectTrainer& trainer, ProgressBar& bar, std::string& summary) {
  try {
    const TrainingOutcome outcome = trainOne(options, job, trainer, bar);
    summary = "trained already";
    if (outcome.unchanged) return true;
    char time[32];
    std::snprintf(time, sizeof(time), ", %.1f s", outcome.seconds);
    summary = describe(outcome.model) + time;
    if (outcome.self_test) summary += "\n  " + describe(*outcome.self_test);
    if (outcome.report.views_seen > 0) summary += describe(outcome.report);
    return true;
  } catch (const std::exception& error) {
    std::string reason = error.what();
    if (reason.rfind(job.name + ": ", 0) == 0) reason.erase(0, job.name.size() + 2);
    summary = "not trained: " + reason;
    return false;
  }
}

int run(const Options& options) {
  if (options.commands.given()) return options.commands.run(ModelStore(options.models));
  const std::vector<Job> jobs = listJobs(options);
  ObjectTrainer trainer(options.models, settingsOf(options));
  const bool terminal = isatty(STDERR_FILENO) == 1;
  std::vector<std::string> lines;
  int failures = 0;
  {
    ProgressBar progress("training", static_cast<int>(jobs.size()));
    for (const Job& job : jobs) {
      std::string summary;
      failures += !train(options, job, trainer, progress, summary);
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
      "Trains models of objects from textured meshes (PLY, OBJ, GLB, DAE, STL), recordings (on a fiducial board, or "
      "with tf), or one labelled view, and puts them into a model store; keeps that store.");
  app.footer(
      "Objects that the store has already, trained from the same with the same parameters, are skipped: an "
      "interrupted run goes on where it stopped.\n"
      "Exit code: 0 if all objects are in the store, 1 if one could not be trained, 2 if none was tried, above 100 for "
      "wrong arguments.");
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
  app.add_option("--challenge-ids", options.challenge_ids, "yaml of name: id, for result files of a challenge")
      ->check(CLI::ExistingFile);
  app.add_option("--id", options.id, "the object's number in result files [one that is free, from 1001]")
      ->check(CLI::NonNegativeNumber)
      ->needs(name);
  app.add_flag("--untextured", options.untextured, "train also a mesh without texture, which is hardly ever found");
  app.add_flag("--no-self-test", options.no_self_test, "do not look for a mesh's new model in rendered frames");
  app.add_option("--shard", options.shard, "K/N: only every N-th object, the K-th of N processes that share --models");
  auto* overwrite = app.add_flag("--overwrite", options.overwrite, "train also what the store has");
  auto* extend = app.add_flag("--extend", options.extend,
                              "add these views to the model that the store has; the object may stand otherwise");
  extend->excludes(overwrite);
  app.add_flag("--turned-over", options.turned_over,
               "with --extend: the object stands on its head, which makes it surer")
      ->needs(extend);
  addRecordingOptions(app, options.recording, name);
  options.commands.addTo(app);
  addParameters(app, options.settings.meshes.list(), "training", "Training from meshes");
  addParameters(app, recordingParameters(options.settings.recording), "recording", "Training from recordings");
  mesh->needs(name)->excludes(bop);
  name->excludes(bop);
  try {
    app.parse(argc, argv);
    silenceLibraries();
    if (options.mesh.empty() && options.bop.empty() && !options.recording.given() && !options.commands.given())
      throw CLI::RequiredError("--mesh, --bop, --bag, --bags, --frames, --color, or a command such as --list");
    return run(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "train: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) { return recognition::main(argc, argv); }
