// recognize: finds trained objects in recorded frames.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include <CLI/CLI.hpp>

#include "tools/frame_source.h"
#include "tools/progress_bar.h"
#include "tools/silence.h"
#include "rgbd_recognition/annotation.h"
#include "core/image_file.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "evaluation/result_files.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "tools/bag_source.h"
#endif

namespace recognition {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string models, config, out;
  std::string bop, color, depth, camera;
  std::string bag, color_topic, info_topic, depth_topic;
  double max_interval = 0.02;  // seconds
  BopSplitOptions split{"", true};
  bool all_frames = false;
};

std::unique_ptr<FrameSource> openSource(const Options& options) {
  if (!options.bop.empty()) return openBopSource(options.bop, {options.split.sensor, !options.all_frames});
#ifdef RGBD_RECOGNITION_HAS_BAGS
  if (!options.bag.empty())
    return openBagSource(options.bag,
                         {options.color_topic, options.info_topic, options.depth_topic, options.max_interval});
#else
  if (!options.bag.empty()) throw std::runtime_error("--bag: built without ROS, so bags cannot be read");
#endif
  if (options.color.empty() || options.depth.empty() || options.camera.empty())
    throw std::runtime_error("give --bag, --bop, or --color with --depth and --camera");
  return openFileSource(options.color, options.depth, options.camera);
}

void printTable(const NamedFrame& frame, const RecognitionResult& result, const ModelDatabase& database) {
  std::printf("%s: %zu found in %.0f ms (segmentation %.0f, features %.0f, hypotheses %.0f, verification %.0f)\n",
              frame.name.c_str(), result.detections.size(), 1e3 * result.times.total, 1e3 * result.times.segmentation,
              1e3 * result.times.feature_extraction, 1e3 * result.times.hypothesis_generation,
              1e3 * result.times.reprojection_verification);
  for (const VerifiedHypothesis& d : result.detections) {
    const Eigen::Vector3d t = d.camera_from_object.translation();
    const Eigen::Quaterniond q(d.camera_from_object.linear());
    std::printf(
        "  %-40.40s confidence %.2f  xyz [%.3f %.3f %.3f] m  quaternion xyzw [%.3f %.3f %.3f %.3f]  "
        "consensus %zu\n",
        database.objects[static_cast<size_t>(d.hypothesis.object)]->name.c_str(), d.confidence, t.x(), t.y(), t.z(),
        q.x(), q.y(), q.z(), q.w(), d.hypothesis.consensus.size());
  }
  std::fflush(stdout);
}

void writeAnnotated(const fs::path& directory, const NamedFrame& frame, const RecognitionResult& result,
                    const ModelDatabase& database) {
  cv::Mat image = bgrCopy(frame.frame);
  std::vector<Annotation> annotations;
  for (const VerifiedHypothesis& d : result.detections)
    annotations.push_back(
        {d.hypothesis.object, d.camera_from_object,
         nameWithConfidence(database.objects[static_cast<size_t>(d.hypothesis.object)]->name, d.confidence)});
  drawAnnotations(image, annotations, database, frame.frame.color_camera);
  const std::string name = "annotated_" + sixDigits(frame.run) + "_" + sixDigits(frame.number) + ".png";
  writeImage((directory / name).string(), image);
}

std::vector<ResultRow> rowsOf(const NamedFrame& frame, const RecognitionResult& result, const ModelDatabase& database) {
  std::vector<ResultRow> rows;
  std::map<int, int> instances;
  for (const VerifiedHypothesis& d : result.detections) {
    const ObjectModel& object = *database.objects[static_cast<size_t>(d.hypothesis.object)];
    ResultRow row;
    row.stamp = frame.stamp;
    row.run = frame.run;
    row.frame = frame.number;
    row.object_id = object.challenge_id;
    row.instance = instances[d.hypothesis.object]++;
    row.object = object.name;
    row.confidence = d.confidence;
    row.seconds = result.times.total;
    row.camera_from_object = d.camera_from_object;
    rows.push_back(row);
  }
  return rows;
}

/// Files of the results, each frame's as soon as it is done: an interrupted run keeps them. None without a folder.
class Output {
 public:
  explicit Output(const std::string& folder) : folder_(folder) {
    if (folder.empty()) return;
    fs::create_directories(folder);
    csv_.open(folder_ / "detections.csv");
    writeNamedHeader(csv_);
    requireWritten();
  }

  void write(const NamedFrame& frame, const RecognitionResult& result, const ModelDatabase& database) {
    if (folder_.empty()) return;
    writeNamedRows(csv_, rowsOf(frame, result, database));
    requireWritten();
    writeAnnotated(folder_, frame, result, database);
  }

 private:
  void requireWritten() {
    if (!csv_.flush()) throw std::runtime_error((folder_ / "detections.csv").string() + ": cannot be written");
  }

  const fs::path folder_;
  std::ofstream csv_;
};

struct Counts {
  int searched = 0, refused = 0;
};

Counts searchAll(FrameSource& source, Recognizer& recognizer, Output& output) {
  ProgressBar progress("recognize", source.size());
  Counts counts;
  for (NamedFrame frame;;) {
    try {
      if (!source.next(frame)) return counts;
      const RecognitionResult result = recognizer.recognize(frame.frame);
      ++counts.searched;
      printTable(frame, result, recognizer.database());
      output.write(frame, result, recognizer.database());
    } catch (const std::exception& error) {
      ++counts.refused;
      std::fprintf(stderr, "recognize: %s; frame skipped\n", error.what());
    }
    progress.advance(frame.name);
  }
}

int run(const Options& options) {
  const ModelStore::LoadResult loaded = ModelStore(options.models).loadAll();
  for (const std::string& error : loaded.errors) std::fprintf(stderr, "recognize: %s\n", error.c_str());
  if (loaded.database->objects.empty()) throw std::runtime_error(options.models + ": holds no model");
  const auto source = openSource(options);
  const RecognizerParameters parameters =
      options.config.empty() ? RecognizerParameters() : RecognizerParameters::fromYaml(options.config);
  Recognizer recognizer(parameters, loaded.database);
  Output output(options.out);
  const Counts counts = searchAll(*source, recognizer, output);
  if (const std::string remarks = source->remarks(); !remarks.empty())
    std::fprintf(stderr, "recognize: %s\n", remarks.c_str());
  if (counts.searched == 0) std::fprintf(stderr, "recognize: no frame could be searched\n");
  return counts.refused == 0 && counts.searched > 0 ? 0 : 1;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  recognition::Options options;
  CLI::App app{
      "Finds trained objects in recorded RGB-D frames: a table on standard output, annotated images and the "
      "challenge's CSV in --out."};
  app.add_option("--models", options.models, "model store (directory made by train)")->required();
  app.add_option("--config", options.config, "parameter file, e.g. config/paper.yaml");
  app.add_option("--out", options.out, "folder for annotated_*.png and detections.csv");
  auto* bag = app.add_option(
      "--bag", options.bag, "rosbag; the topics of openni, the challenge, RealSense and Azure are found by themselves");
  auto* bop = app.add_option("--bop", options.bop, "split of a BOP data set: the folder that holds the scenes NNNNNN");
  auto* color = app.add_option("--color", options.color, "colour image of a single frame");
  app.add_option("--depth", options.depth, "16-bit depth image of a single frame")->needs(color);
  app.add_option("--camera", options.camera,
                 "camera of a single frame: JSON (BOP's scene_camera.json or camera.json, K, fx fy cx cy), ROS's "
                 "camera_info as yaml or ini, or nine numbers")
      ->needs(color);
  app.add_option("--sensor", options.split.sensor, "with --bop, of several sensors the one named so")->needs(bop);
  app.add_flag("--all-frames", options.all_frames, "with --bop, also frames that test_targets_bop19.json does not list")
      ->needs(bop);
  app.add_option("--max-interval", options.max_interval, "with --bag, between a colour image and its depth, seconds")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->needs(bag);
  bag->excludes(bop)->excludes(color);
  bop->excludes(color);
  auto* topic = app.add_option("--color-topic", options.color_topic, "colour images in the bag, if it has other topics")
                    ->needs(bag);
  app.add_option("--info-topic", options.info_topic, "camera info of the colour images")->needs(topic);
  app.add_option("--depth-topic", options.depth_topic, "registered depth images or organised clouds")->needs(topic);
  CLI11_PARSE(app, argc, argv);
  recognition::silenceLibraries();
  try {
    return recognition::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recognize: %s\n", error.what());
    return 1;
  }
}
