// evaluate: runs recognition over a BOP split and says how good it is.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include <CLI/CLI.hpp>

#include "tools/frame_source.h"
#include "tools/progress_bar.h"
#include "tools/silence.h"
#include "rgbd_recognition/core/frame_check.h"
#include "rgbd_recognition/core/image_file.h"
#include "rgbd_recognition/evaluation/report.h"
#include "evaluation/report_markdown.h"
#include "rgbd_recognition/evaluation/result_files.h"
#include "evaluation/threshold_sweep.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string models;
  std::string split;
  std::vector<std::string> configs;
  std::string out;
  int jobs = 1;
  int frames = 0;
  bool resume = false;
  bool only_trained = false;
  bool all_frames = false;
  std::string sensor;
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

/// What a run's records depend on.
std::string describe(const Options& options, RecognizerParameters parameters) {
  std::string text = "models: " + options.models + "\nbop: " + options.split + "\n";
  for (const auto& [group, list] : parameters.groups()) {
    text += group + ":\n";
    for (const Parameter& p : list) text += "  " + p.name + ": " + valueText(p) + "\n";
  }
  return text;
}

/// Throws std::runtime_error if an earlier run in `directory` was made of something else.
void claim(const fs::path& directory, const std::string& description, bool resume) {
  const fs::path file = directory / "run.yaml";
  if (resume && fs::exists(file)) {
    std::ostringstream earlier;
    earlier << std::ifstream(file).rdbuf();
    if (earlier.str() != description)
      throw std::runtime_error(file.string() + " tells of other models, data or parameters: cannot be resumed");
  }
  write(file, description);
}

/// Records of an earlier, interrupted run. A last line cut short by the interruption is dropped.
std::map<std::pair<int, int>, FrameRecord> readRecords(const fs::path& file) {
  std::map<std::pair<int, int>, FrameRecord> records;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    try {
      const FrameRecord record = fromJsonLine(line);
      records[{record.scene, record.frame}] = record;
    } catch (const std::runtime_error& error) {
      std::fprintf(stderr, "evaluate: %s: %s; that frame runs again\n", file.c_str(), error.what());
    }
  }
  return records;
}

/// Evaluates all frames, `jobs` at a time; each worker has its own Recognizer over the same prepared models. Frames
/// already in `records` are skipped.
void runFrames(const Options& options, const RecognizerParameters& parameters,
               std::shared_ptr<const ModelDatabase> database, const std::vector<BopFrame>& frames, const fs::path& file,
               std::map<std::pair<int, int>, FrameRecord>& records) {
  std::vector<const BopFrame*> open;
  for (const BopFrame& frame : frames)
    if (!records.count({frame.scene, frame.frame})) open.push_back(&frame);
  const Recognizer prepared(parameters, database);
  std::ofstream log(file, std::ios::app);
  ProgressBar progress("evaluate", static_cast<int>(open.size()));
  std::atomic<size_t> next{0};
  std::mutex mutex;  // guards records, log and failure
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      Recognizer recognizer(prepared);
      for (size_t i = next++; i < open.size(); i = next++) {
        const FrameRecord record = evaluateFrame(recognizer, *open[i], options.only_trained);
        const std::lock_guard<std::mutex> lock(mutex);
        records[{record.scene, record.frame}] = record;
        log << toJsonLine(record) << std::endl;
        progress.advance(open[i]->name());
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = std::current_exception();
      next = open.size();
    }
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < options.jobs; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
}

std::vector<ResultRow> resultRows(const std::vector<FrameRecord>& records) {
  std::vector<ResultRow> rows;
  for (const FrameRecord& record : records) {
    std::map<int, int> instances;
    for (const HypothesisRecord& d : record.detections) {
      ResultRow row;
      row.run = record.scene;
      row.frame = record.frame;
      row.object_id = d.object_id;
      row.instance = instances[d.object_id]++;
      row.confidence = d.confidence;
      row.seconds = record.times.total;
      row.camera_from_object = d.camera_from_object;
      rows.push_back(row);
    }
  }
  return rows;
}

void writeResults(const fs::path& directory, const std::vector<FrameRecord>& records) {
  const std::vector<ResultRow> rows = resultRows(records);
  std::ostringstream challenge, bop;
  writeChallengeCsv(challenge, rows);
  writeBopCsv(bop, rows);
  write(directory / "results_challenge.csv", challenge.str());
  write(directory / "results_bop19.csv", bop.str());
}

/// One configuration over the split; returns its sweep for the joint picture.
MarkdownRun runConfig(const Options& options, const std::string& config, std::shared_ptr<const ModelDatabase> database,
                      const std::vector<BopFrame>& frames, const fs::path& directory) {
  RecognizerParameters parameters;
  if (!config.empty()) parameters = RecognizerParameters::fromYaml(config);
  fs::create_directories(directory);
  claim(directory, describe(options, parameters), options.resume);
  const fs::path log = directory / "frames.jsonl";
  std::map<std::pair<int, int>, FrameRecord> by_frame;
  if (options.resume)
    by_frame = readRecords(log);
  else
    fs::remove(log);
  runFrames(options, parameters, database, frames, log, by_frame);

  MarkdownRun run;
  for (const BopFrame& frame : frames) run.records.push_back(by_frame.at({frame.scene, frame.frame}));
  run.info = {config.empty() ? "default" : fs::path(config).filename().string(), options.models, options.split,
              options.jobs};
  run.report = makeReport(run.records);
  const VerificationParameters& decision = parameters.reprojection_verification;
  const bool paper = decision.decision == Decision::kPaper;
  run.sweep = {run.info.config + (paper ? ": theta_c" : ": min_confidence"),
               sweepThreshold(run.records, paper ? DecisionMeasure::kTotalConsistency : DecisionMeasure::kConfidence),
               paper ? decision.theta_c : decision.min_confidence};
  write(directory / "report.json", reportJson(run.report, run.records, run.info));
  write(directory / "sweep.csv", sweepCsv(run.sweep.points));
  writeResults(directory, run.records);
  std::cout << reportText(run.report, run.records, run.info) << "\n";
  return run;
}

/// Whether a frame can be read and is fit to be searched; says why not.
bool isFit(const BopFrame& frame) {
  try {
    requireFit(loadBopFrame(frame));
    return true;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate: %s: %s; frame left out\n", frame.name().c_str(), error.what());
    return false;
  }
}

/// Those with ground truth that are fit; says what is left out.
std::vector<BopFrame> selectFrames(const Options& options) {
  BopSplit split = openBopSplit(options.split, {options.sensor, !options.all_frames});
  if (const std::string remarks = remarksOn(split); !remarks.empty())
    std::fprintf(stderr, "evaluate: %s\n", remarks.c_str());
  std::vector<BopFrame>& frames = split.frames;
  const size_t all = frames.size();
  frames.erase(std::remove_if(frames.begin(), frames.end(), [](const BopFrame& f) { return !f.has_ground_truth; }),
               frames.end());
  if (frames.empty())
    throw std::runtime_error(options.split + ": has no ground truth (scene_gt.json); recognize goes without it");
  if (frames.size() < all)
    std::fprintf(stderr, "evaluate: frames left out, as they have no ground truth: %zu\n", all - frames.size());
  if (options.frames > 0 && static_cast<size_t>(options.frames) < frames.size())
    frames.resize(static_cast<size_t>(options.frames));
  frames.erase(std::remove_if(frames.begin(), frames.end(), [](const BopFrame& frame) { return !isFit(frame); }),
               frames.end());
  if (frames.empty()) throw std::runtime_error(options.split + ": no frame can be searched");
  return std::move(frames);
}

/// Results tell objects by their challenge id alone.
void warnOfSharedIds(const ModelDatabase& database) {
  std::map<int, std::string> names;
  for (const auto& object : database.objects) {
    const auto [first, is_new] = names.emplace(object->challenge_id, object->name);
    if (!is_new && object->challenge_id >= 0)
      std::fprintf(stderr, "evaluate: models %s and %s share the challenge id %d: each counts as the other\n",
                   first->second.c_str(), object->name.c_str(), object->challenge_id);
  }
}

int run(const Options& options) {
  const ModelStore::LoadResult loaded = ModelStore(options.models).loadAll();
  for (const std::string& error : loaded.errors) std::fprintf(stderr, "evaluate: %s\n", error.c_str());
  if (loaded.database->objects.empty()) throw std::runtime_error(options.models + ": holds no model");
  warnOfSharedIds(*loaded.database);
  const std::vector<BopFrame> frames = selectFrames(options);
  std::vector<std::string> configs = options.configs;
  if (configs.empty()) configs.emplace_back();
  std::set<fs::path> names;
  for (const std::string& config : configs)
    if (!names.insert(fs::path(config).stem()).second)
      throw std::invalid_argument("two configurations are named " + fs::path(config).stem().string());
  std::vector<MarkdownRun> runs;
  for (const std::string& config : configs) {
    const fs::path directory =
        configs.size() == 1 ? fs::path(options.out) : fs::path(options.out) / fs::path(config).stem();
    runs.push_back(runConfig(options, config, loaded.database, frames, directory));
  }
  std::vector<NamedSweep> sweeps;
  for (const MarkdownRun& r : runs) sweeps.push_back(r.sweep);
  writeImage((fs::path(options.out) / "sweep.png").string(), drawSweeps(sweeps));
  writeMarkdownReport(options.out, runs, frames, *loaded.database);
  std::cout << "written: " << (fs::path(options.out) / "report.md").string() << "\n";
  return 0;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  recognition::Options options;
  CLI::App app{
      "Runs recognition over a BOP split and reports score, precision, recall, pose accuracy, times and the cause of "
      "each miss."};
  app.add_option("--models", options.models, "model store (directory made by train)")->required();
  app.add_option("--bop", options.split, "split of a BOP data set: the folder that holds the scenes NNNNNN")
      ->required();
  app.add_option("--config", options.configs,
                 "parameter file, e.g. config/paper.yaml; several give one run each, side by side");
  app.add_option("--out", options.out, "folder for report.json, report.md, sweep.png, result CSVs")->required();
  app.add_option("--jobs", options.jobs,
                 "frames at a time; more than 1 makes the set faster and the single frame slower")
      ->check(CLI::Range(1, 256));
  app.add_option("--frames", options.frames, "only the first N frames")->check(CLI::PositiveNumber);
  app.add_flag("--resume", options.resume, "go on where an interrupted run with the same arguments stopped");
  app.add_option("--sensor", options.sensor, "of a data set with several sensors the one named so, as in rgb_SENSOR");
  app.add_flag("--all-frames", options.all_frames, "also frames that test_targets_bop19.json does not list");
  app.add_flag("--only-trained", options.only_trained, "leave out instances of objects that the store has no model of");
  CLI11_PARSE(app, argc, argv);
  recognition::silenceLibraries();
  try {
    return recognition::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate: %s\n", error.what());
    return 1;
  }
}
