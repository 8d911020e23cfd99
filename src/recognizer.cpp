#include "rgbd_recognition/recognizer.h"

#include <chrono>
#include <iterator>

#include "rgbd_recognition/features/active_features.h"

namespace rgbd_recognition {
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

Recognizer::Recognizer(const RecognizerParameters& parameters, std::shared_ptr<const ModelDatabase> database)
    : parameters_(parameters),
      database_(std::move(database)),
      segmenter_(parameters.segmentation, extentLimits(*database_)),
      extractor_(makeFeatureExtractor(parameters.feature_extraction)),
      generator_(std::make_shared<const HypothesisGenerator>(parameters.hypothesis_generation, database_,
                                                             parameters.feature_extraction.descriptor)),
      prepared_models_(std::make_shared<const PreparedModels>(*database_)) {
  parameters.validate();
}

Recognizer::Recognizer(const Recognizer& other)
    : parameters_(other.parameters_),
      database_(other.database_),
      segmenter_(parameters_.segmentation, extentLimits(*database_)),
      extractor_(other.extractor_),
      generator_(other.generator_),
      prepared_models_(other.prepared_models_) {}

Recognizer::~Recognizer() = default;

RecognitionResult Recognizer::recognize(const RgbdFrame& frame) {
  frame.validate();
  RecognitionResult result;
  StageTimes& times = result.times;
  LapTimer timer;

  const CameraModel camera = frame.depthCamera();
  const cv::Mat depth = depthInMetres(frame.depth);
  result.segmentation = segmenter_.segment(depth, camera);
  times.segmentation = timer.lap();

  result.features =
      extractSceneFeatures(*extractor_, parameters_.feature_extraction, frame, depth, result.segmentation);
  times.feature_extraction = timer.lap();

  result.matches = generator_->match(result.features);
  times.hypothesis_generation = timer.lap();

  const SceneView scene = SceneView::make(frame, depth, result.segmentation, result.features);
  HypothesisVerifier verifier(parameters_.reprojection_verification, prepared_models_, scene);
  std::vector<std::uint8_t> active;  // all
  std::vector<int> objects;          // all
  for (bool finished = false; !finished; ++result.rounds) {
    timer.lap();
    const auto hypotheses =
        generator_->generate(result.features, result.matches, active, objects, result.rounds, &result.generation);
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

}  // namespace rgbd_recognition
