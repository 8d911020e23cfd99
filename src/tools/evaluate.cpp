// evaluate: runs recognition over a BOP split and says how good it is.

#include <unistd.h>

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
#include "core/shard.h"
#include "tools/progress_bar.h"
#include "tools/sequence_evaluation.h"
#include "tools/silence.h"
#include "core/frame_check.h"
#include "core/image_file.h"
#include "rgbd_recognition/evaluation/report.h"
#include "evaluation/report_markdown.h"
#include "evaluation/result_files.h"
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
  FrameEvaluation evaluation;
  bool all_frames = false;
  std::string sensor;
  Shard shard;
  bool merge = false;
  bool sequence = false;
  SequenceEvaluation of_sequence;

  /// Of this process; all of a run are "frames*.jsonl".
  std::string logName() const {
    if (shard.whole()) return "frames.jsonl";
    return "frames-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".jsonl";
  }
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

std::string textOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
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

/// Throws std::runtime_error if an earlier run or another shard in `directory` was made of something else.
void claim(const fs::path& directory, const std::string& description, const Options& options) {
  const fs::path file = directory / "run.yaml";
  const bool joins = options.resume || options.merge || !options.shard.whole();
  if (joins && fs::exists(file)) {
    if (textOf(file) != description)
      throw std::runtime_error(file.string() +
                               " tells of other models, data or parameters: cannot be resumed or joined");
    return;
  }
  const fs::path unfinished = file.string() + "." + std::to_string(getpid());  // shards start together
  write(unfinished, description);
  fs::rename(unfinished, file);
}

using Records = std::map<std::pair<int, int>, FrameRecord>;

/// Adds the records of an earlier, interrupted run. A last line cut short by the interruption is dropped.
void readRecords(const fs::path& file, Records& records) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    try {
      const FrameRecord record = fromJsonLine(line);
      records[{record.scene, record.frame}] = record;
    } catch (const std::runtime_error& error) {
      std::fprintf(stderr, "evaluate: %s: %s; that frame has to run again\n", file.c_str(), error.what());
    }
  }
}

/// "frames.jsonl" and those of shards.
std::vector<fs::path> recordFiles(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(directory))
    if (entry.path().filename().string().rfind("frames", 0) == 0 && entry.path().extension() == ".jsonl")
      files.push_back(entry.path());
  return files;
}

/// Of all shards. Throws std::runtime_error that counts the frames that none has.
Records mergeRecords(const fs::path& directory, const std::vector<BopFrame>& frames) {
  Records records;
  for (const fs::path& file : recordFiles(directory)) readRecords(file, records);
  int missing = 0;
  std::string first;
  for (const BopFrame& frame : frames)
    if (!records.count({frame.scene, frame.frame}) && missing++ == 0) first = frame.name();
  if (missing > 0)
    throw std::runtime_error(directory.string() + ": " + std::to_string(missing) + " of " +
                             std::to_string(frames.size()) + " frames are in no shard's records, " + first +
                             " first: run the shards that are missing or broke off, with --resume");
  return records;
}

/// Every N-th frame.
std::vector<BopFrame> framesOf(const Shard& shard, const std::vector<BopFrame>& frames) {
  std::vector<BopFrame> own;
  for (size_t i = 0; i < frames.size(); ++i)
    if (shard.takes(i)) own.push_back(frames[i]);
  return own;
}

/// Evaluates all frames, `jobs` at a time; each worker has its own Recognizer over the same prepared models. Frames
/// already in `records` are skipped.
void runFrames(const Options& options, const RecognizerParameters& parameters,
               std::shared_ptr<const ModelDatabase> database, const std::vector<BopFrame>& frames, const fs::path& file,
               Records& records) {
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
        const FrameRecord record = evaluateFrame(recognizer, *open[i], options.evaluation);
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

/// Records of this shard's frames, or of all when shards are merged.
Records collectRecords(const Options& options, const RecognizerParameters& parameters,
                       std::shared_ptr<const ModelDatabase> database, const std::vector<BopFrame>& frames,
                       const fs::path& directory) {
  fs::create_directories(directory);
  claim(directory, describe(options, parameters), options);
  if (options.merge) return mergeRecords(directory, frames);
  const fs::path log = directory / options.logName();
  Records records;
  if (options.resume)
    readRecords(log, records);
  else if (options.shard.whole())
    for (const fs::path& earlier : recordFiles(directory)) fs::remove(earlier);
  else
    fs::remove(log);
  runFrames(options, parameters, database, framesOf(options.shard, frames), log, records);
  return records;
}

DecisionMeasure measureOf(const VerificationParameters& decision) {
  if (decision.decision == Decision::kConfidence) return DecisionMeasure::kConfidence;
  return decision.further_rounds == FurtherRounds::kAcceptance ? DecisionMeasure::kTotalConsistency
                                                               : DecisionMeasure::kTotalConsistencyAllRounds;
}

/// One configuration over the split; returns its sweep for the joint picture.
MarkdownRun runConfig(const Options& options, const std::string& config, std::shared_ptr<const ModelDatabase> database,
                      const std::vector<BopFrame>& frames, const fs::path& directory) {
  RecognizerParameters parameters;
  if (!config.empty()) parameters = RecognizerParameters::fromYaml(config);
  const Records by_frame = collectRecords(options, parameters, database, frames, directory);
  if (!options.shard.whole()) return {};

  MarkdownRun run;
  for (const BopFrame& frame : frames) run.records.push_back(by_frame.at({frame.scene, frame.frame}));
  run.info = {config.empty() ? "default" : fs::path(config).filename().string(), options.models, options.split,
              options.jobs};
  run.report = makeReport(run.records);
  const VerificationParameters& decision = parameters.reprojection_verification;
  const bool paper = decision.decision == Decision::kPaper;
  run.sweep = {run.info.config + (paper ? ": theta_c" : ": min_confidence"),
               sweepThreshold(run.records, measureOf(decision)), paper ? decision.theta_c : decision.min_confidence};
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
  ProgressBar progress("checking", static_cast<int>(frames.size()));
  const auto isUnfit = [&progress](const BopFrame& frame) {
    const bool fit = isFit(frame);
    progress.advance(frame.name());
    return !fit;
  };
  frames.erase(std::remove_if(frames.begin(), frames.end(), isUnfit), frames.end());
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
  if (options.sequence) {
    SequenceEvaluation evaluation = options.of_sequence;
    evaluation.out = options.out;
    evaluation.only_trained = options.evaluation.only_trained;
    const std::string& config = configs.front();
    evaluateSequences(evaluation, config.empty() ? RecognizerParameters() : RecognizerParameters::fromYaml(config),
                      loaded.database, frames);
    return 0;
  }
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
  if (!options.shard.whole()) {
    std::cout << "shard " << options.shard.text() << " is done: evaluate --merge with the same arguments joins them\n";
    return 0;
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
  std::string shard = options.shard.text();
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
  auto* shard_option =
      app.add_option("--shard", shard, "K/N: only every N-th frame, the K-th of N processes that share --out");
  app.add_flag("--merge", options.merge, "run nothing: join the records of all shards in --out into the reports")
      ->excludes(shard_option);
  app.add_flag("--only-trained", options.evaluation.only_trained,
               "leave out instances of objects that the store has no model of");
  app.add_flag("--oracle", options.evaluation.oracle,
               "also test the true pose of each missed instance, and tell what would have become of it");
  auto* sequence = app.add_flag("--sequence", options.sequence,
                                "each scene is a film: how well its objects are followed, and detected beside it");
  app.add_option("--rate", options.of_sequence.rate, "frames a second of the film")
      ->check(CLI::Range(1.0, 1000.0))
      ->needs(sequence);
  app.add_option("--search-seconds", options.of_sequence.search_seconds,
                 "of the film's time that a search takes; 0: as long as here")
      ->check(CLI::Range(0.0, 60.0))
      ->needs(sequence);
  CLI11_PARSE(app, argc, argv);
  recognition::silenceLibraries();
  try {
    options.shard = recognition::Shard::parse(shard);
    return recognition::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate: %s\n", error.what());
    return 1;
  }
}
