#include "evaluation/oracle.h"

#include <map>
#include <utility>

namespace recognition {
namespace {

constexpr float kRightPlace = 0.02f;  // metres between a feature and its true place

/// Upper ends of bands, with a name for each and one for what is beyond the last.
struct Scale {
  std::string measure;
  std::vector<std::pair<double, std::string>> bands;
  std::string beyond;

  std::string nameOf(double value) const {
    for (const auto& [end, name] : bands)
      if (value < end) return measure + " " + name;
    return measure + " " + beyond;
  }
};

const Scale kVisibility{
    "visibility", {{0.3, "0-30 %"}, {0.5, "30-50 %"}, {0.7, "50-70 %"}, {0.9, "70-90 %"}}, "90-100 %"};
const Scale kPixels{
    "pixels", {{1000, "0-999"}, {2000, "1000-1999"}, {4000, "2000-3999"}, {8000, "4000-7999"}}, "8000 on"};
const Scale kDistance{
    "distance", {{0.75, "0-0.75 m"}, {1.0, "0.75-1 m"}, {1.25, "1-1.25 m"}, {1.5, "1.25-1.5 m"}}, "1.5 m on"};
const Scale kCorrespondences{
    "right correspondences", {{1, "0"}, {3, "1-2"}, {5, "3-4"}, {8, "5-7"}, {20, "8-19"}}, "20 on"};

void add(const TruthRecord& truth, OracleCount* count) {
  ++count->instances;
  if (!truth.oracle) return;
  ++count->missed;
  const MissCause cause = truth.trace.cause;
  count->proposed += cause == MissCause::kFailedTest || cause == MissCause::kLostConflict ? 1 : 0;
  count->accepted += truth.oracle->rejection == "none" ? 1 : 0;
}

}  // namespace

std::vector<Correspondence> correctCorrespondences(const RecognitionResult& result, const ObjectModel& model,
                                                   int object, const Pose& camera_from_object) {
  std::vector<Correspondence> correct;
  const auto features = model.features.find(result.features.image.type);
  if (features == model.features.end() || static_cast<size_t>(object) >= result.matches.by_object.size())
    return correct;
  std::map<int, Correspondence> nearest;  // by scene feature
  for (const Correspondence& c : result.matches.by_object[static_cast<size_t>(object)]) {
    const Eigen::Vector3f place =
        camera_from_object.cast<float>() * features->second.positions[static_cast<size_t>(c.model_feature)];
    if ((place - result.features.points[static_cast<size_t>(c.scene_feature)]).norm() >= kRightPlace) continue;
    const auto [at, is_new] = nearest.emplace(c.scene_feature, c);
    if (!is_new && c.distance < at->second.distance) at->second = c;
  }
  for (const auto& [feature, c] : nearest) correct.push_back(c);
  return correct;
}

Hypothesis trueHypothesis(const RecognitionResult& result, const ModelDatabase& database, int object,
                          const Pose& camera_from_object, int min_consensus) {
  Hypothesis hypothesis;
  hypothesis.object = object;
  hypothesis.camera_from_object = camera_from_object;
  hypothesis.consensus =
      correctCorrespondences(result, *database.objects.at(static_cast<size_t>(object)), object, camera_from_object);
  if (static_cast<int>(hypothesis.consensus.size()) >= min_consensus) return hypothesis;
  hypothesis.source = hypothesis.consensus.empty() ? HypothesisSource::kShape : HypothesisSource::kCorrespondence;
  if (!hypothesis.consensus.empty()) hypothesis.consensus.resize(1);
  return hypothesis;
}

std::vector<OracleBand> oracleBands(const std::vector<FrameRecord>& records) {
  std::map<std::pair<int, std::string>, OracleCount> bands;  // scales in order
  bool tested = false;
  for (const FrameRecord& record : records)
    for (const TruthRecord& truth : record.truth) {
      tested = tested || truth.oracle.has_value();
      const double distance = truth.camera_from_object.translation().norm();
      add(truth, &bands[{0, "all"}]);
      add(truth, &bands[{1, kVisibility.nameOf(truth.visibility)}]);
      add(truth, &bands[{2, kPixels.nameOf(truth.trace.visible_pixels)}]);
      add(truth, &bands[{3, kDistance.nameOf(distance)}]);
      add(truth, &bands[{4, kCorrespondences.nameOf(truth.trace.correct_correspondences)}]);
    }
  std::vector<OracleBand> result;
  if (!tested) return result;
  for (const auto& [key, count] : bands) result.push_back({key.second, count});
  return result;
}

}  // namespace recognition
