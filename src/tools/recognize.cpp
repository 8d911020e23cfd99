// recognize: finds trained objects in recorded frames.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include <CLI/CLI.hpp>

#include "tools/frame_source.h"
#include "tools/progress_bar.h"
#include "rgbd_recognition/annotation.h"
#include "rgbd_recognition/core/image_file.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/evaluation/result_files.h"
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
};

std::unique_ptr<FrameSource> openSource(const Options& options) {
  if (!options.bop.empty()) return openBopSource(options.bop);
#ifdef RGBD_RECOGNITION_HAS_BAGS
  if (!options.bag.empty())
    return openBagSource(options.bag, options.color_topic, options.info_topic, options.depth_topic);
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
    std::printf("  %-40.40s confidence %.2f  xyz [%.3f %.3f %.3f] m  quaternion xyzw [%.3f %.3f %.3f %.3f]  "
                "consensus %zu\n",
                database.objects[static_cast<size_t>(d.hypothesis.object)]->name.c_str(), d.confidence, t.x(), t.y(),
                t.z(), q.x(), q.y(), q.z(), q.w(), d.hypothesis.consensus.size());
  }
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

void appendRows(std::vector<ResultRow>& rows, const NamedFrame& frame, const RecognitionResult& result,
                const ModelDatabase& database) {
  std::map<int, int> instances;
  for (const VerifiedHypothesis& d : result.detections) {
    ResultRow row;
    row.stamp = frame.stamp;
    row.run = frame.run;
    row.frame = frame.number;
    row.object_id = database.objects[static_cast<size_t>(d.hypothesis.object)]->challenge_id;
    row.instance = instances[d.hypothesis.object]++;
    row.confidence = d.confidence;
    row.seconds = result.times.total;
    row.camera_from_object = d.camera_from_object;
    rows.push_back(row);
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
  if (!options.out.empty()) fs::create_directories(options.out);

  ProgressBar progress("recognize", source->size());
  std::vector<ResultRow> rows;
  int bad_frames = 0;
  for (NamedFrame frame;;) {
    try {
      if (!source->next(frame)) break;
      const RecognitionResult result = recognizer.recognize(frame.frame);
      printTable(frame, result, *loaded.database);
      appendRows(rows, frame, result, *loaded.database);
      if (!options.out.empty()) writeAnnotated(options.out, frame, result, *loaded.database);
    } catch (const std::exception& error) {
      ++bad_frames;
      std::fprintf(stderr, "recognize: %s; frame skipped\n", error.what());
    }
    progress.advance(frame.name);
  }
  if (!options.out.empty()) {
    std::ofstream csv(fs::path(options.out) / "detections.csv");
    writeChallengeCsv(csv, rows);
    if (!csv.flush()) throw std::runtime_error(options.out + "/detections.csv: cannot be written");
  }
  return bad_frames == 0 ? 0 : 1;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  recognition::Options options;
  CLI::App app{"Finds trained objects in recorded RGB-D frames: a table on standard output, annotated images and the "
               "challenge's CSV in --out."};
  app.add_option("--models", options.models, "model store (directory made by train)")->required();
  app.add_option("--config", options.config, "parameter file, e.g. config/paper.yaml");
  app.add_option("--out", options.out, "folder for annotated_*.png and detections.csv");
  auto* bag =
      app.add_option("--bag", options.bag, "rosbag; openni's topics or the challenge's are found by themselves");
  auto* bop = app.add_option("--bop", options.bop, "split of a BOP data set: the folder that holds the scenes NNNNNN");
  auto* color = app.add_option("--color", options.color, "colour image of a single frame");
  app.add_option("--depth", options.depth, "16-bit depth image of a single frame")->needs(color);
  app.add_option("--camera", options.camera,
                 "camera of a single frame: JSON with cam_K and depth_scale, as BOP's scene_camera.json")
      ->needs(color);
  bag->excludes(bop)->excludes(color);
  bop->excludes(color);
  auto* topic =
      app.add_option("--color-topic", options.color_topic, "colour images in the bag, if it has other topics")
          ->needs(bag);
  app.add_option("--info-topic", options.info_topic, "camera info of the colour images")->needs(topic);
  app.add_option("--depth-topic", options.depth_topic, "registered depth images or organised clouds")->needs(topic);
  CLI11_PARSE(app, argc, argv);
  try {
    return recognition::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recognize: %s\n", error.what());
    return 1;
  }
}
