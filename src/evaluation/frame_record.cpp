#include "rgbd_recognition/evaluation/frame_record.h"
#include "evaluation/oracle.h"
#include "rgbd_recognition/core/frame.h"
#include "core/frame_check.h"

#include <stdexcept>

namespace recognition {
namespace {

int findById(const ModelDatabase& database, int id) {
  for (size_t i = 0; i < database.objects.size(); ++i)
    if (database.objects[i]->challenge_id == id) return static_cast<int>(i);
  return -1;
}

HypothesisRecord record(const VerifiedHypothesis& h, const ModelDatabase& database) {
  const ObjectModel& object = *database.objects.at(static_cast<size_t>(h.hypothesis.object));
  HypothesisRecord result;
  result.object = object.name;
  result.object_id = object.challenge_id;
  result.camera_from_object = h.camera_from_object;
  result.covariance = h.covariance;
  result.scores = h.scores;
  result.evidence = h.evidence;
  result.confidence = h.confidence;
  result.consensus = static_cast<int>(h.hypothesis.consensus.size());
  result.source = sourceName(h.hypothesis.source);
  result.level = testLevelName(h.level);
  result.round = h.hypothesis.round;
  result.rejection = rejectionName(h.rejection);
  result.conflict_with = h.conflict_with;
  return result;
}

std::vector<HypothesisRecord> recordAll(const std::vector<VerifiedHypothesis>& all, const ModelDatabase& database) {
  std::vector<HypothesisRecord> result;
  for (const VerifiedHypothesis& h : all) result.push_back(record(h, database));
  return result;
}

std::vector<TruthRecord> knownTruth(const BopFrame& source, const ModelDatabase& database, bool only_trained) {
  std::vector<TruthRecord> result;
  for (const GroundTruth& truth : source.ground_truth) {
    const int object = findById(database, truth.object_id);
    if (object < 0 && only_trained) continue;
    if (object < 0)
      throw std::runtime_error(source.name() + ": ground truth names object " + std::to_string(truth.object_id) +
                               ", of which the store has no model");
    result.push_back({truth.object_id,
                      database.objects[static_cast<size_t>(object)]->name,
                      truth.camera_from_object,
                      truth.visibility,
                      {},
                      std::nullopt});
  }
  return result;
}

/// What the budgets cut.
std::vector<std::string> leftOut(const RecognitionResult& found) {
  std::vector<std::string> result = found.search.left_out;
  const size_t objects = found.generation.objects_cut_short.size();
  if (objects > 0) result.push_back("matching of " + std::to_string(objects) + " objects");
  return result;
}

template <typename Instance>
std::vector<ScoredInstance> scored(const std::vector<Instance>& instances) {
  std::vector<ScoredInstance> result;
  for (const Instance& instance : instances) result.push_back({instance.object_id, instance.camera_from_object});
  return result;
}

}  // namespace

FrameScore scoreOf(const FrameRecord& record) { return scoreFrame(scored(record.detections), scored(record.truth)); }

FrameRecord evaluateFrame(Recognizer& recognizer, const BopFrame& source, const FrameEvaluation& options) {
  const ModelDatabase& database = recognizer.database();
  FrameRecord result;
  result.scene = source.scene;
  result.frame = source.frame;
  result.truth = knownTruth(source, database, options.only_trained);

  const RgbdFrame frame = loadBopFrame(source);
  const std::string problem = frameProblem(frame);
  if (!problem.empty()) throw std::runtime_error(source.name() + ": " + problem);
  const RecognitionResult found = recognizer.recognize(frame);
  result.times = found.times;
  result.cpu_times = found.cpu_times;
  result.rounds = found.rounds;
  result.features = found.features.image.count();
  result.left_out = leftOut(found);
  result.detections = recordAll(found.detections, database);
  result.hypotheses = recordAll(found.hypotheses, database);

  std::vector<bool> hit(result.truth.size(), false);
  for (const Hit& h : scoreOf(result).hits) hit[static_cast<size_t>(h.truth)] = true;
  for (size_t i = 0; i < result.truth.size(); ++i) {
    TruthRecord& truth = result.truth[i];
    truth.trace =
        traceInstance(frame, found, database, findById(database, truth.object_id), truth.camera_from_object, hit[i]);
    if (!options.oracle || hit[i]) continue;
    const Hypothesis at_truth =
        trueHypothesis(found, database, findById(database, truth.object_id), truth.camera_from_object,
                       recognizer.parameters().hypothesis_generation.min_consensus);
    truth.oracle = record(recognizer.test(frame, found, {at_truth}).front(), database);
  }
  return result;
}

}  // namespace recognition
