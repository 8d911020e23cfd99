#include "rgbd_recognition/recognizer.h"

#include <chrono>
#include <iterator>

#include "alignment/prepared_model.h"
#include "alignment/scene_view.h"
#include "features/active_features.h"
#include "features/feature_extractor.h"
#include "matching/hypothesis_generator.h"
#include "segmentation/segmenter.h"
#include "verification/hypothesis_verifier.h"

namespace recognition {
namespace {

/// Seconds since the last call (or since construction).
class LapTimer {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
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

RecognitionResult Recognizer::recognize(const RgbdFrame& frame) {
  frame.validate();
  RecognitionResult result;
  StageTimes& times = result.times;
  LapTimer timer;

  const CameraModel camera = frame.depthCamera();
  const cv::Mat depth = depthInMetres(frame.depth);
  result.segmentation = stages_->segmenter.segment(depth, camera);
  times.segmentation = timer.lap();

  result.features =
      extractSceneFeatures(*stages_->extractor, stages_->parameters.feature_extraction, frame, depth, result.segmentation);
  times.feature_extraction = timer.lap();

  result.matches = stages_->generator->match(result.features);
  times.hypothesis_generation = timer.lap();

  const SceneView scene = SceneView::make(frame, depth, result.segmentation, result.features);
  HypothesisVerifier verifier(stages_->parameters.reprojection_verification, stages_->prepared_models, scene);
  std::vector<std::uint8_t> active;  // all
  std::vector<int> objects;          // all
  for (bool finished = false; !finished; ++result.rounds) {
    timer.lap();
    const auto hypotheses =
        stages_->generator->generate(result.features, result.matches, active, objects, result.rounds, &result.generation);
    times.hypothesis_generation += timer.lap();
    RoundOutcome outcome = verifier.verify(hypotheses, result.rounds, result.rounds == 0 ? &result.matches : nullptr);
    times.reprojection_verification += timer.lap();
    active = activeFeatures(result.features, outcome.explained, frame.colorPerDepthPixel());
    objects = outcome.candidates;
    finished = outcome.finished;
    std::move(outcome.hypotheses.begin(), outcome.hypotheses.end(), std::back_inserter(result.hypotheses));
  }
  result.detections = verifier.detections();
  times.total =
      times.segmentation + times.feature_extraction + times.hypothesis_generation + times.reprojection_verification;
  return result;
}

}  // namespace recognition
