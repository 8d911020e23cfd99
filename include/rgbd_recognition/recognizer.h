#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"
#include "rgbd_recognition/matching/matching_parameters.h"
#include "rgbd_recognition/matching/scene_matches.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/search/search_report.h"
#include "rgbd_recognition/segmentation/segmentation.h"
#include "rgbd_recognition/segmentation/segmentation_parameters.h"
#include "rgbd_recognition/verification/verification_parameters.h"
#include "rgbd_recognition/verification/verified_hypothesis.h"

namespace recognition {

class PreparedModels;

/// All parameters of the pipeline; one group a stage, named as the nodelet and the yaml's top-level key.
struct RecognizerParameters {
  SegmentationParameters segmentation;               ///< "segmentation"
  FeatureParameters feature_extraction;              ///< "feature_extraction"
  MatchingParameters hypothesis_generation;          ///< "hypothesis_generation"
  VerificationParameters reprojection_verification;  ///< "reprojection_verification"

  /// Group names with their parameters; the pointers inside are into this object.
  std::vector<std::pair<std::string, ParameterList>> groups();

  void validate() const;

  /// Reads config/*.yaml: group -> name -> value over the defaults. Throws std::invalid_argument that names file,
  /// group, key and value of anything unknown, mistyped or out of range.
  static RecognizerParameters fromYaml(const std::string& file);
};

/// Time of each stage, seconds.
struct StageTimes {
  double segmentation = 0.0;
  double feature_extraction = 0.0;
  double hypothesis_generation = 0.0;
  double reprojection_verification = 0.0;
  double total = 0.0;
};

/// One frame's answer with everything on the way to it.
struct RecognitionResult {
  std::vector<VerifiedHypothesis> detections;  ///< by falling confidence
  std::vector<VerifiedHypothesis> hypotheses;  ///< all, of all rounds, with scores and reason
  Segmentation segmentation;
  SceneFeatures features;
  SceneMatches matches;
  GenerationReport generation;
  SearchReport search;
  int rounds = 0;
  StageTimes times;      ///< wall time
  StageTimes cpu_times;  ///< CPU time of the process: all threads, and all that runs beside in it
};

/// The whole loop of Fig. 1 in one call, for tools, benchmarks and tests. The nodelets run the same stages. One
/// Recognizer serves one thread at a time.
class Recognizer {
 public:
  Recognizer(const RecognizerParameters& parameters, std::shared_ptr<const ModelDatabase> database);
  /// Another one over the same prepared models. Both may run at the same time.
  Recognizer(const Recognizer& other);
  ~Recognizer();

  /// The result does not depend on the number of threads. std::invalid_argument for a frame that does not validate.
  RecognitionResult recognize(const RgbdFrame& frame);
  /// The same of the segments that `select` leaves of the frame's; where it leaves none, nothing is searched.
  RecognitionResult recognize(const RgbdFrame& frame, const std::function<Segmentation(const Segmentation&)>& select);

  /// Tests poses in full, as if they had been proposed; `result` is the frame's. No hypothesis excludes another one.
  std::vector<VerifiedHypothesis> test(const RgbdFrame& frame, const RecognitionResult& result,
                                       const std::vector<Hypothesis>& hypotheses) const;

  const ModelDatabase& database() const;
  const RecognizerParameters& parameters() const;
  /// The models as the search reads them, for those who read them beside it.
  std::shared_ptr<const PreparedModels> preparedModels() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace recognition
