#include <benchmark/benchmark.h>

#include "verification/pose_verification.h"
#include "alignment/pose_refiner.h"
#include "alignment/synthetic_scene.h"
#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"

namespace recognition {
namespace {

/// A box before a wall at 640x480, 0.7 m away, as in most frames; one thread.
struct Bench {
  synthetic::Solid solid = synthetic::box(1);
  Pose pose = synthetic::poseAt({0.0, 0.0, 0.7});
  ObjectModel object = synthetic::makeModel(solid, "box");
  PreparedModel model = prepareModel(object);
  std::unique_ptr<synthetic::Scene> scene = synthetic::render({{solid, pose}}, {object}, {});

  Bench() { cv::setNumThreads(1); }
  Hypothesis hypothesis() const {
    Hypothesis start = scene->truth[0];
    start.camera_from_object = synthetic::disturbed(pose, 0.008, 4.0, 3);
    return start;
  }
};

void sceneView(benchmark::State& state) {
  const Bench bench;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        SceneView::make(bench.scene->frame, bench.scene->depth, bench.scene->segmentation, bench.scene->features));
  }
}
BENCHMARK(sceneView)->Unit(benchmark::kMillisecond);

void depthBuffer(benchmark::State& state) {
  const Bench bench;
  for (auto _ : state) benchmark::DoNotOptimize(reproject(bench.model, bench.pose, bench.scene->view.camera));
  state.counters["points"] = static_cast<double>(bench.model.positions.size());
}
BENCHMARK(depthBuffer)->Unit(benchmark::kMillisecond);

void refinement(benchmark::State& state) {
  const Bench bench;
  const Hypothesis start = bench.hypothesis();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        refinePose(bench.model, bench.object, start, start.camera_from_object, bench.scene->view, {}));
  }
}
BENCHMARK(refinement)->Unit(benchmark::kMillisecond);

/// All of one hypothesis; argument: 0 the paper's test, 1 ours without and 2 ours with refinement.
void hypothesisTest(benchmark::State& state) {
  const Bench bench;
  const Hypothesis start = bench.hypothesis();
  VerificationParameters parameters;
  parameters.refine = state.range(0) == 2;
  if (state.range(0) == 0) {
    parameters.decision = Decision::kPaper;
    parameters.illumination_compensation = false;
    parameters.w = 4;
  }
  const PreparedModels models(synthetic::databaseOf({bench.object}));
  const auto rule = makeAcceptanceRule(parameters, 0);
  const PoseVerification verification(parameters, {}, models, bench.scene->view, bench.scene->segmentation, *rule);
  for (auto _ : state) {
    benchmark::DoNotOptimize(verification.test(start));
  }
}
BENCHMARK(hypothesisTest)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace recognition

BENCHMARK_MAIN();
