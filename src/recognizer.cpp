#include "rgbd_recognition/recognizer.h"

#include <chrono>
#include <ctime>
#include <iterator>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "features/active_features.h"
#include "core/stopwatch.h"
#include "features/feature_extractor.h"
#include "matching/hypothesis_generator.h"
#include "segmentation/segmenter.h"
#include "search/frame_search.h"
#include "verification/pose_verification.h"

namespace recognition {
namespace {

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Adds what passes between its calls to stages.
class StageClock {
 public:
  explicit StageClock(RecognitionResult* result) : result_(result), cpu_(cpuSeconds()) {}

  void endOf(double StageTimes::*stage) {
    const double wall = watch_.seconds(), cpu = cpuSeconds();
    for (double StageTimes::*part : {stage, &StageTimes::total}) {
      result_->times.*part += wall - wall_;
      result_->cpu_times.*part += cpu - cpu_;
    }
    wall_ = wall;
    cpu_ = cpu;
  }

 private:
  RecognitionResult* result_;
  Stopwatch watch_;
  double wall_ = 0.0, cpu_;
};

}  // namespace

struct Recognizer::Stages {
  Stages(const RecognizerParameters& all_parameters, std::shared_ptr<const ModelDatabase> models)
      : parameters(all_parameters),
        database(std::move(models)),
        segmenter(parameters.segmentation, extentLimits(*database)),
        extractor(makeFeatureExtractor(parameters.feature_extraction)),
        generator(std::make_shared<const HypothesisGenerator>(parameters.hypothesis_generation, database,
                                                              parameters.feature_extraction.descriptor)),
        prepared_models(std::make_shared<const PreparedModels>(*database)) {
    parameters.validate();
    prepared_models->prepareAll();
  }

  /// A segmenter of its own; the rest is immutable and shared.
  Stages(const Stages& other)
      : parameters(other.parameters),
        database(other.database),
        segmenter(parameters.segmentation, extentLimits(*database)),
        extractor(other.extractor),
        generator(other.generator),
        prepared_models(other.prepared_models) {}

  RecognizerParameters parameters;
  std::shared_ptr<const ModelDatabase> database;
  Segmenter segmenter;
  std::shared_ptr<const FeatureExtractor> extractor;
  std::shared_ptr<const HypothesisGenerator> generator;
  std::shared_ptr<const PreparedModels> prepared_models;
};

Recognizer::Recognizer(const RecognizerParameters& parameters, std::shared_ptr<const ModelDatabase> database)
    : stages_(std::make_unique<Stages>(parameters, std::move(database))) {}

Recognizer::Recognizer(const Recognizer& other) : stages_(std::make_unique<Stages>(*other.stages_)) {}

Recognizer::~Recognizer() = default;

const ModelDatabase& Recognizer::database() const { return *stages_->database; }

const RecognizerParameters& Recognizer::parameters() const { return stages_->parameters; }

std::vector<VerifiedHypothesis> Recognizer::test(const RgbdFrame& frame, const RecognitionResult& result,
                                                 const std::vector<Hypothesis>& hypotheses) const {
  VerificationParameters parameters = stages_->parameters.reprojection_verification;
  parameters.exhaustive = true;
  const SceneView scene = SceneView::make(frame, depthInMetres(frame.depth), result.segmentation, result.features);
  const auto rule = makeAcceptanceRule(parameters, 0);
  const PoseVerification verification(parameters, MatchingLimits(stages_->parameters.hypothesis_generation),
                                      *stages_->prepared_models, scene, result.segmentation, *rule);
  std::vector<VerifiedHypothesis> tested;
  for (const Hypothesis& hypothesis : hypotheses) tested.push_back(verification.test(hypothesis).verified);
  return tested;
}

std::shared_ptr<const PreparedModels> Recognizer::preparedModels() const { return stages_->prepared_models; }

RecognitionResult Recognizer::recognize(const RgbdFrame& frame) { return recognize(frame, nullptr); }

RecognitionResult Recognizer::recognize(const RgbdFrame& frame,
                                        const std::function<Segmentation(const Segmentation&)>& select) {
  frame.validate();
  RecognitionResult result;
  StageClock clock(&result);
  const RecognizerParameters& parameters = stages_->parameters;

  const CameraModel camera = frame.depthCamera();
  const cv::Mat depth = depthInMetres(frame.depth);
  result.segmentation = stages_->segmenter.segment(depth, camera);
  if (select) result.segmentation = select(result.segmentation);
  clock.endOf(&StageTimes::segmentation);
  if (select && result.segmentation.patches.empty()) return result;

  result.features =
      extractSceneFeatures(*stages_->extractor, parameters.feature_extraction, frame, depth, result.segmentation);
  clock.endOf(&StageTimes::feature_extraction);

  result.matches = stages_->generator->match(result.features);
  clock.endOf(&StageTimes::hypothesis_generation);

  const SceneView scene = SceneView::make(frame, depth, result.segmentation, result.features);
  FrameSearch search(parameters.reprojection_verification, MatchingLimits(parameters.hypothesis_generation),
                     stages_->prepared_models, scene);
  std::vector<std::uint8_t> active;  // all
  std::vector<int> objects;          // all
  clock.endOf(&StageTimes::reprojection_verification);
  for (bool finished = false; !finished; ++result.rounds) {
    const auto hypotheses = stages_->generator->generate(result.features, result.matches, active, objects,
                                                         result.rounds, &result.generation);
    clock.endOf(&StageTimes::hypothesis_generation);
    RoundOutcome outcome = search.run(hypotheses, result.rounds, result.rounds == 0 ? &result.matches : nullptr);
    active = activeFeatures(result.features, outcome.explained, frame.colorPerDepthPixel());
    objects = outcome.candidates;
    finished = outcome.finished;
    std::move(outcome.hypotheses.begin(), outcome.hypotheses.end(), std::back_inserter(result.hypotheses));
    clock.endOf(&StageTimes::reprojection_verification);
  }
  result.detections = search.detections();
  result.search = search.report();
  for (const int object : result.generation.objects_cut_short)
    result.search.left_out.push_back("part of the search for " +
                                     stages_->database->objects[static_cast<size_t>(object)]->name);
  return result;
}

}  // namespace recognition
