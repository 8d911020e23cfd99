// Matching and Algorithm 2 for growing numbers of objects: time, memory, loading, and what the index misses against the
// exhaustive reference.

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <sstream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "benchmarks/grouping_comparison.h"
#include "benchmarks/neighbour_comparison.h"
#include "benchmarks/printed_objects.h"
#include "features/lifting.h"
#include "matching/hypothesis_generator.h"
#include "rgbd_recognition/model/model_store.h"
#include "features/feature_extractor.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition::benchmarks {
namespace {

const DescriptorType kType = FeatureParameters().descriptor;
constexpr int kPool = 10;         // objects that stand in scenes
constexpr int kSceneObjects = 8;  // of these in a scene
constexpr int kRepeats = 5;       // of which the fastest counts
constexpr double kNear = 0.03;    // metres: a found pose is right within this
constexpr double kTurned = 0.35;  // radians

struct Options {
  std::string summary, models, store;
  std::vector<int> objects = {10, 50, 200, 1000};
  int scenes = 12;
  double reference_s = 300.0;
  int features = 1000;
  int correspondences = 2000;
  int hnsw = 200;
};

struct TestScene {
  SceneFeatures features;
  std::vector<std::string> names;
  std::vector<Pose> poses;
};

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double residentMegabytes() {
  malloc_trim(0);
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

TestScene makeScene(const std::vector<PrintedObject>& objects, int seed, int features) {
  FeatureParameters parameters;
  parameters.max_features = features;
  TestScene scene;
  std::vector<std::shared_ptr<const TexturedMesh>> meshes;
  for (int i = 0; i < kSceneObjects; ++i) {
    const PrintedObject& object = objects[static_cast<size_t>(seed + i) % objects.size()];
    meshes.push_back(object.mesh);
    scene.names.push_back(object.model->name);
  }
  const PrintedScene printed = makePrintedScene(meshes, seed);
  scene.poses = printed.camera_from_object;
  const ImageFeatures image =
      makeFeatureExtractor(parameters)->extract(toGray(printed.frame.color, ColorOrder::kBgr), printed.regions);
  scene.features = liftFeatures(image, depthInMetres(printed.frame.depth), printed.frame.depthCamera(),
                                printed.frame.colorPerDepthPixel());
  return scene;
}

/// One flag an object of the scene: whether a hypothesis has it at its place.
std::vector<bool> foundIn(const TestScene& scene, const ModelDatabase& database,
                          const std::vector<Hypothesis>& hypotheses) {
  std::vector<bool> found;
  for (size_t i = 0; i < scene.names.size(); ++i)
    found.push_back(std::any_of(hypotheses.begin(), hypotheses.end(), [&](const Hypothesis& h) {
      return database.objects[h.object]->name == scene.names[i] &&
             translationDistance(h.camera_from_object, scene.poses[i]) < kNear &&
             rotationDistance(h.camera_from_object, scene.poses[i]) < kTurned;
    }));
  return found;
}

/// Matches scene by scene, until all are done or `most_s` seconds are over; the fastest milliseconds of each, and what
/// was found.
struct Run {
  std::vector<double> ms, cpu_ms, search_cpu_ms;
  std::vector<bool> found;

  Run(const HypothesisGenerator& generator, const ModelDatabase& database, const std::vector<TestScene>& scenes,
      int repeats, double most_s) {
    const auto start = std::chrono::steady_clock::now();
    for (const TestScene& scene : scenes) {
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > most_s) break;
      std::vector<Hypothesis> hypotheses;
      double best = 1e9, best_cpu = 1e9, best_search = 1e9;
      for (int i = 0; i < repeats; ++i) {
        const std::clock_t cpu_before = std::clock();  // of all threads
        best = std::min(best, secondsOf([&] {
                          const SceneMatches matches = generator.match(scene.features);
                          best_search = std::min(best_search, static_cast<double>(std::clock() - cpu_before));
                          hypotheses = generator.generate(scene.features, matches, {}, {}, 0);
                        }));
        best_cpu = std::min(best_cpu, static_cast<double>(std::clock() - cpu_before) / CLOCKS_PER_SEC);
      }
      ms.push_back(1e3 * best);
      cpu_ms.push_back(1e3 * best_cpu);
      search_cpu_ms.push_back(1e3 * best_search / CLOCKS_PER_SEC);
      const std::vector<bool> here = foundIn(scene, database, hypotheses);
      found.insert(found.end(), here.begin(), here.end());
    }
  }
};

nlohmann::json measure(const ModelStore& store, const std::vector<TestScene>& scenes, const Options& options) {
  std::shared_ptr<const ModelDatabase> database;
  std::unique_ptr<HypothesisGenerator> generator;
  const double before = residentMegabytes();
  const std::clock_t cpu_before = std::clock();
  const double load_s = secondsOf([&] {
    database = store.loadAll({kType}).database;
    generator = std::make_unique<HypothesisGenerator>(MatchingParameters(), database, kType);
  });
  const double load_cpu_s = static_cast<double>(std::clock() - cpu_before) / CLOCKS_PER_SEC;
  const double memory_mb = residentMegabytes() - before;
  const Run index(*generator, *database, scenes, kRepeats, std::numeric_limits<double>::max());

  MatchingParameters parameters;
  parameters.search = SearchMode::kExhaustive;
  parameters.work_limit_ms = 60000.0;
  const Run reference(HypothesisGenerator(parameters, database, kType), *database, scenes, 1, options.reference_s);
  const bool with_hnsw = static_cast<int>(database->objects.size()) <= options.hnsw;
  const nlohmann::json neighbours = compareNeighbourSearch(*database, kType, scenes.front().features.image.descriptors,
                                                           parameters.neighbors, with_hnsw);
  int detections = 0, kept = 0;
  for (size_t i = 0; i < reference.found.size(); ++i) {
    detections += reference.found[i];
    kept += reference.found[i] && index.found[i];
  }
  return {{"ms", median(index.ms)},
          {"cpu_ms", median(index.cpu_ms)},  // what other programs disturb less
          {"search_cpu_ms", median(index.search_cpu_ms)},
          {"exhaustive_ms", median(reference.ms)},
          {"exhaustive_cpu_ms", median(reference.cpu_ms)},
          {"recall_vs_exhaustive", detections > 0 ? static_cast<double>(kept) / detections : 0.0},
          {"memory_mb", memory_mb},
          {"load_s", load_s},
          {"load_cpu_s", load_cpu_s},
          {"recall_at_1", neighbours["index"]["recall_at_1"]},
          {"neighbours", neighbours},
          {"found", std::count(index.found.begin(), index.found.end(), true)},
          {"exhaustive_found", detections},
          {"instances", index.found.size()},
          {"exhaustive_instances", reference.found.size()}};
}

/// Objects for a growing store: first those of the scenes, then those of another store, where given, then generated
/// ones.
class ObjectSource {
 public:
  explicit ObjectSource(const Options& options) : extractor_(makeFeatureExtractor(FeatureParameters())) {
    for (int i = 0; i < kPool; ++i) pool_.push_back(makePrintedObject(i, *extractor_, kType));
    if (options.models.empty()) return;
    const ModelStore store(options.models);
    for (const std::string& name : store.names()) names_.push_back(name);
    others_ = std::make_unique<ModelStore>(store);
  }

  const std::vector<PrintedObject>& pool() const { return pool_; }

  /// Not those that are there already.
  void saveObject(int number, const ModelStore& to) const {
    if (static_cast<int>(to.names().size()) > number) return;
    const auto own = static_cast<size_t>(number), other = own - pool_.size();
    if (own < pool_.size()) return to.save(*pool_[own].model);
    if (other < names_.size()) return to.save(others_->load(names_[other], {kType}));
    to.save(*makePrintedObject(number, *extractor_, kType).model);
  }

 private:
  std::unique_ptr<FeatureExtractor> extractor_;
  std::vector<PrintedObject> pool_;
  std::vector<std::string> names_;
  std::unique_ptr<ModelStore> others_;
};

nlohmann::json scaling(const Options& options) {
  const ObjectSource objects(options);
  std::vector<TestScene> scenes;
  for (int i = 0; i < options.scenes; ++i) scenes.push_back(makeScene(objects.pool(), i, options.features));

  nlohmann::json table;
  const auto temporary = std::filesystem::temp_directory_path() / ("benchmark_matching_" + std::to_string(getpid()));
  const std::filesystem::path directory = options.store.empty() ? temporary : std::filesystem::path(options.store);
  std::vector<int> counts = options.objects;
  std::sort(counts.begin(), counts.end());
  for (const int count : counts) {
    const ModelStore store((directory / std::to_string(count)).string());
    for (int i = 0; i < count; ++i) objects.saveObject(i, store);
    table[std::to_string(count)] = measure(store, scenes, options);
    std::cout << count << " objects: " << table[std::to_string(count)] << std::endl;
  }
  std::filesystem::remove_all(temporary);
  return table;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Times matching and Algorithm 2 against the exhaustive reference and PCL's grouping");
  app.add_option("--summary", options.summary, "JSON file to write");
  app.add_option("--models", options.models, "model store whose objects stand beside the generated ones");
  app.add_option("--store", options.store, "folder for the generated stores, kept and used again");
  app.add_option("--objects", options.objects, "numbers of objects")->delimiter(',')->check(CLI::PositiveNumber);
  app.add_option("--scenes", options.scenes, "scenes of 8 objects")->check(CLI::PositiveNumber);
  app.add_option("--reference-seconds", options.reference_s, "for the exhaustive reference on each number of objects")
      ->check(CLI::PositiveNumber);
  app.add_option("--features", options.features, "features a scene")->check(CLI::PositiveNumber);
  app.add_option("--correspondences", options.correspondences, "of the comparison with PCL")
      ->check(CLI::PositiveNumber);
  app.add_option("--hnsw", options.hnsw,
                 "most objects for which the search is compared with hnswlib's (slow to build)");
  CLI11_PARSE(app, argc, argv);
  const nlohmann::json grouping = compareGrouping(options.correspondences, 1);
  for (const auto& row : grouping) std::cout << row << std::endl;
  nlohmann::json summary = scaling(options);
  summary["outliers"] = grouping;
  if (!options.summary.empty() && !(std::ofstream(options.summary) << summary.dump(2) << "\n"))
    throw std::runtime_error(options.summary + " cannot be written");
  return 0;
}

}  // namespace
}  // namespace recognition::benchmarks

int main(int argc, char** argv) {
  try {
    return recognition::benchmarks::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "benchmark_matching: " << error.what() << "\n";
    return 1;
  }
}
