// Times and quality of segmentation beside PCL's, in one run on the same frames, one thread each.
//
//   benchmark_segmentation --mosd DIR --bop SPLIT_DIR --summary FILE [Google Benchmark's options]
//
// Frames: labelled Kinect clouds (--mosd; quality is measured on these), depth of a BOP split (--bop), and simulated
// ones, always.

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>

#include "benchmarks/pcl_segmentation.h"
#include "segmentation/edge_detector.h"
#include "segmentation/segmenter.h"
#include "segmentation/analytic_scene.h"
#include "benchmarks/segmentation_quality.h"

namespace recognition {
namespace {

constexpr int kRepetitions = 5;
/// Size limits of a set with cereal boxes of 34 cm and cans: that of 35 household objects.
const Extents kLimits{0.03, 0.62, 0.3};

struct ModeName {
  SegmentationMode mode;
  const char* name;
};
constexpr ModeName kModes[] = {{SegmentationMode::kSimpleLinear, "simple_linear"},
                               {SegmentationMode::kSimpleQuadratic, "simple_quadratic"},
                               {SegmentationMode::kLsMixed, "ls_mixed"},
                               {SegmentationMode::kLsAicc, "ls_aicc"}};

SegmentationParameters parametersOf(SegmentationMode mode) {
  SegmentationParameters parameters;
  parameters.mode = mode;
  return parameters;
}

DepthFrame simulatedFrame(double scale, int seed) {
  DepthFrame frame;
  frame.camera = CameraModel{640, 480, 525.0, 525.0, 319.5, 239.5}.scaled(scale);
  frame.name = "simulated/" + std::to_string(frame.camera.width) + "/" + std::to_string(seed);
  const cv::Mat ideal = randomTableScene(static_cast<std::uint64_t>(seed), 7).render(frame.camera).depth;
  frame.depth = kinectDepth(ideal, frame.camera, static_cast<std::uint64_t>(seed), 0.5, 0.003);
  return frame;
}

/// Processor time of the whole process, milliseconds: with one thread what a quiet machine's wall clock shows.
double processorMilliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Least of several runs.
template <typename Run>
double leastTime(Run run) {
  double least = 1e9;
  for (int i = 0; i < kRepetitions; ++i) {
    const double start = processorMilliseconds();
    run();
    least = std::min(least, processorMilliseconds() - start);
  }
  return least;
}

cv::Mat inverseOf(const cv::Mat& depth) {
  cv::Mat inverse(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      inverse.at<float>(v, u) = depth.at<float>(v, u) > 0.0f ? 1.0f / depth.at<float>(v, u) : 0.0f;
  return inverse;
}

void addQuality(const SegmentationQuality& quality, const std::string& prefix, nlohmann::json* summary) {
  (*summary)[prefix + "under_segmentation"] = quality.underSegmentation();
  (*summary)[prefix + "object_coverage"] = quality.coverage();
  (*summary)[prefix + "table_left"] = quality.tableLeft();
  (*summary)[prefix + "patches_per_object"] = quality.patchesPerObject();
  (*summary)[prefix + "missed_objects"] = quality.missedShare();
}

/// Time of Algorithm 1 (Table II's) and of all of segmentation, mean over frames; quality over labelled ones.
void measureMode(const ModeName& mode, const std::vector<DepthFrame>& frames, nlohmann::json* summary) {
  EdgeDetector detector(parametersOf(mode.mode));
  Segmenter segmenter(parametersOf(mode.mode), kLimits);
  double edges_time = 0.0, total_time = 0.0;
  SegmentationQuality quality;
  cv::Mat edges;
  for (const DepthFrame& frame : frames) {
    const cv::Mat inverse = inverseOf(frame.depth);
    edges_time += leastTime([&] { detector.detect(inverse, frame.camera, &edges); });
    Segmentation result;
    total_time += leastTime([&] { result = segmenter.segment(frame.depth, frame.camera); });
    if (!frame.labels.empty()) quality.add(frame, result.labels);
  }
  const double n = static_cast<double>(frames.size());
  const std::string name = mode.name;
  (*summary)[name + "_ms"] = edges_time / n;
  (*summary)[name + "_total_ms"] = total_time / n;
  const bool is_default = mode.mode == SegmentationParameters().mode;
  if (is_default) (*summary)["regions_ms"] = (total_time - edges_time) / n;
  if (quality.objects > 0) addQuality(quality, is_default ? "" : name + "_", summary);
}

void measurePcl(const std::vector<DepthFrame>& frames, nlohmann::json* summary) {
  double time = 0.0;
  SegmentationQuality quality;
  for (const DepthFrame& frame : frames) {
    const PclSegmentation pcl(frame);
    cv::Mat labels;
    time += leastTime([&] { labels = pcl.segment(); });
    if (!frame.labels.empty()) quality.add(frame, labels);
  }
  (*summary)["pcl_ms"] = time / static_cast<double>(frames.size());
  if (quality.objects > 0) addQuality(quality, "pcl_", summary);
}

nlohmann::json summarise(const std::vector<DepthFrame>& frames) {
  nlohmann::json summary;
  summary["frames"] = frames.size();
  for (const ModeName& mode : kModes) measureMode(mode, frames, &summary);
  measurePcl(frames, &summary);
  summary["pcl_ratio"] = summary["ls_mixed_total_ms"].get<double>() / summary["pcl_ms"].get<double>();
  summary["ls_aicc_to_ls_mixed"] = summary["ls_aicc_ms"].get<double>() / summary["ls_mixed_ms"].get<double>();
  return summary;
}

void segmentFrames(benchmark::State& state, const std::vector<DepthFrame>& frames, SegmentationMode mode, int threads) {
  cv::setNumThreads(threads);
  Segmenter segmenter(parametersOf(mode), kLimits);
  size_t next = 0;
  SegmentationTimes sum;
  for (auto _ : state) {
    const DepthFrame& frame = frames[next++ % frames.size()];
    benchmark::DoNotOptimize(segmenter.segment(frame.depth, frame.camera));
    sum.edges += segmenter.times().edges;
    sum.planes += segmenter.times().planes;
    sum.components += segmenter.times().components;
    sum.expansion += segmenter.times().expansion;
  }
  const auto milliseconds = [&](double seconds) {
    return benchmark::Counter(1e3 * seconds, benchmark::Counter::kAvgIterations);
  };
  state.counters["edges_ms"] = milliseconds(sum.edges);
  state.counters["planes_ms"] = milliseconds(sum.planes);
  state.counters["components_ms"] = milliseconds(sum.components);
  state.counters["expansion_ms"] = milliseconds(sum.expansion);
  cv::setNumThreads(1);
}

void registerBenchmarks(const std::vector<DepthFrame>& frames, const std::vector<std::vector<DepthFrame>>& sizes) {
  for (const ModeName& mode : kModes)
    for (const int threads : {1, 2})
      benchmark::RegisterBenchmark(
          (std::string(mode.name) + "/threads:" + std::to_string(threads)).c_str(),
          [&frames, mode, threads](benchmark::State& state) { segmentFrames(state, frames, mode.mode, threads); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
  for (const auto& of_size : sizes)
    benchmark::RegisterBenchmark(
        ("size/" + std::to_string(of_size.front().depth.cols)).c_str(),
        [&of_size](benchmark::State& state) { segmentFrames(state, of_size, SegmentationMode::kLsMixed, 1); })
        ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("pcl", [&frames](benchmark::State& state) {
    const PclSegmentation pcl(frames.front());
    for (auto _ : state) benchmark::DoNotOptimize(pcl.segment());
  })->Unit(benchmark::kMillisecond);
}

/// Takes `name value` out of the arguments; empty if it is not there.
std::string takeOption(const std::string& name, std::vector<char*>* arguments) {
  const auto found = std::find(arguments->begin(), arguments->end(), name);
  if (found == arguments->end()) return "";
  if (found + 1 == arguments->end()) throw std::invalid_argument(name + " needs a value");
  const std::string value = *(found + 1);
  arguments->erase(found, found + 2);
  return value;
}

int run(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  const std::string mosd = takeOption("--mosd", &arguments), bop = takeOption("--bop", &arguments);
  const std::string summary_file = takeOption("--summary", &arguments);
  std::vector<DepthFrame> frames;
  if (!mosd.empty()) frames = readLabelledClouds(mosd);
  if (!bop.empty())
    for (const DepthFrame& frame : readBopDepth(bop)) frames.push_back(frame);
  for (int seed = 1; seed <= 4; ++seed) frames.push_back(simulatedFrame(1.0, seed));
  std::vector<std::vector<DepthFrame>> sizes;
  for (const double scale : {0.5, 1.0, 2.0}) sizes.push_back({simulatedFrame(scale, 1), simulatedFrame(scale, 2)});

  cv::setNumThreads(1);
  int count = static_cast<int>(arguments.size());
  registerBenchmarks(frames, sizes);
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 1;
  benchmark::RunSpecifiedBenchmarks();
  if (summary_file.empty()) return 0;
  const nlohmann::json summary = summarise(frames);
  std::ofstream(summary_file) << summary.dump(2) << "\n";
  std::cout << summary.dump(2) << std::endl;
  return 0;
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  try {
    return recognition::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "benchmark_segmentation: " << error.what() << std::endl;
    return 1;
  }
}
