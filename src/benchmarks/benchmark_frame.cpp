// benchmark_frame: CPU time and memory of one frame through the whole loop, beside OpenCV's SIFT on the same pictures.

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numeric>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"

namespace {

std::atomic<std::uint64_t> allocated_bytes{0}, allocations{0};

}  // namespace

/// Counts what the benchmark and the libraries allocate with new. The C library's own malloc is reached through its
/// other name.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  allocated_bytes.fetch_add(size, std::memory_order_relaxed);
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

namespace recognition {
namespace {

struct Options {
  std::string models, split, config, summary;
  int repetitions = 3, threads = 1, frames = 0;
};

double cpuMilliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / std::max<double>(1.0, static_cast<double>(values.size()));
}

double wallMilliseconds() { return 1e3 * static_cast<double>(cv::getTickCount()) / cv::getTickFrequency(); }

/// SIFT of 1000 points, detected and described in one thread.
double siftMilliseconds(const cv::Mat& gray) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(1000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const double before = cpuMilliseconds();
  sift->detectAndCompute(gray, cv::noArray(), keypoints, descriptors);
  const double spent = cpuMilliseconds() - before;
  cv::setNumThreads(threads);
  return spent;
}

struct FrameCost {
  std::vector<double> cpu, wall, sift, megabytes, allocations;
  StageTimes stages;
};

void measure(Recognizer& recognizer, const RgbdFrame& frame, int repetitions, std::vector<FrameCost>* costs) {
  FrameCost cost;
  const cv::Mat gray = toGray(frame.color, frame.color_order);
  for (int i = 0; i < repetitions; ++i) {
    const double cpu = cpuMilliseconds(), wall = wallMilliseconds();
    const std::uint64_t bytes = allocated_bytes, count = allocations;
    const RecognitionResult result = recognizer.recognize(frame);
    cost.cpu.push_back(cpuMilliseconds() - cpu);
    cost.wall.push_back(wallMilliseconds() - wall);
    cost.megabytes.push_back(static_cast<double>(allocated_bytes - bytes) / 1e6);
    cost.allocations.push_back(static_cast<double>(allocations - count));
    cost.stages = result.cpu_times;
    cost.sift.push_back(siftMilliseconds(gray));
  }
  costs->push_back(cost);
}

nlohmann::json summaryOf(const std::vector<FrameCost>& costs) {
  std::vector<double> cpu, wall, sift, megabytes, counts, ratios;
  nlohmann::json stages;
  for (const FrameCost& cost : costs) {
    cpu.push_back(medianOf(cost.cpu));
    wall.push_back(medianOf(cost.wall));
    sift.push_back(medianOf(cost.sift));
    megabytes.push_back(medianOf(cost.megabytes));
    counts.push_back(medianOf(cost.allocations));
  }
  const auto stage = [&](double StageTimes::*part) {
    std::vector<double> values;
    for (const FrameCost& cost : costs) values.push_back(1e3 * cost.stages.*part);
    return meanOf(values);
  };
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {{"frames", costs.size()},
          {"cpu_ms", meanOf(cpu)},
          {"wall_ms", meanOf(wall)},
          {"sift_ms", meanOf(sift)},
          {"ratio_to_sift", meanOf(cpu) / std::max(1e-9, meanOf(sift))},
          {"peak_mb", static_cast<double>(usage.ru_maxrss) / 1024.0},
          {"allocated_mb_per_frame", meanOf(megabytes)},
          {"allocations_per_frame", meanOf(counts)},
          {"stage_cpu_ms",
           {{"segmentation", stage(&StageTimes::segmentation)},
            {"feature_extraction", stage(&StageTimes::feature_extraction)},
            {"hypothesis_generation", stage(&StageTimes::hypothesis_generation)},
            {"reprojection_verification", stage(&StageTimes::reprojection_verification)}}}};
}

int run(const Options& options) {
  cv::setNumThreads(options.threads);
  const ModelStore::LoadResult loaded = ModelStore(options.models).loadAll();
  for (const std::string& error : loaded.errors) std::fprintf(stderr, "benchmark_frame: %s\n", error.c_str());
  if (loaded.database->objects.empty()) throw std::runtime_error(options.models + ": holds no model");
  RecognizerParameters parameters;
  if (!options.config.empty()) parameters = RecognizerParameters::fromYaml(options.config);
  Recognizer recognizer(parameters, loaded.database);
  std::vector<FrameCost> costs;
  std::vector<BopFrame> frames = readBopSplit(options.split);
  if (options.frames > 0 && static_cast<size_t>(options.frames) < frames.size())
    frames.resize(static_cast<size_t>(options.frames));
  for (const BopFrame& frame : frames) measure(recognizer, loadBopFrame(frame), options.repetitions, &costs);
  if (costs.empty()) throw std::runtime_error(options.split + ": holds no frame");
  nlohmann::json summary = summaryOf(costs);
  summary["threads"] = options.threads;
  summary["objects"] = loaded.database->objects.size();
  std::printf("%s\n", summary.dump(1).c_str());
  if (options.summary.empty()) return 0;
  std::ofstream out(options.summary);
  out << summary.dump(1) << "\n";
  if (!out.flush()) throw std::runtime_error(options.summary + ": cannot be written");
  return 0;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  recognition::Options options;
  CLI::App app{
      "Measures CPU time and memory of whole frames, beside OpenCV's SIFT on the same pictures in the same run."};
  app.add_option("--models", options.models, "model store (directory made by train)")->required();
  app.add_option("--bop", options.split, "split of a BOP data set")->required();
  app.add_option("--config", options.config, "parameter file");
  app.add_option("--summary", options.summary, "file for the figures, JSON");
  app.add_option("--repetitions", options.repetitions, "times that each frame runs; the median counts")
      ->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "threads of recognition; SIFT always has one")
      ->check(CLI::Range(1, 256));
  app.add_option("--frames", options.frames, "only the first N frames")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return recognition::run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_frame: %s\n", error.what());
    return 1;
  }
}
