#include <nlohmann/json.hpp>

#include "rgbd_recognition/evaluation/report.h"

namespace recognition {
namespace {

using nlohmann::json;

json tallyJson(const Tally& tally) {
  return {{"instances", tally.instances},
          {"true_positives", tally.true_positives},
          {"false_negatives", tally.false_negatives},
          {"false_positives", tally.false_positives},
          {"within_3cm_20deg", tally.near_truth},
          {"precision", tally.precision()},
          {"recall", tally.recall()},
          {"pose_accuracy", tally.poseAccuracy()}};
}

json bandsJson(const std::map<std::string, Tally>& tallies, const char* key) {
  json list = json::array();
  for (const auto& [name, tally] : tallies) {
    json entry = tallyJson(tally);
    entry[key] = name;
    list.push_back(entry);
  }
  return list;
}

json truthJson(const TruthRecord& truth, const Hit* hit) {
  json j = {{"object", truth.object},
            {"object_id", truth.object_id},
            {"found", hit != nullptr},
            {"cause", missCauseName(hit ? MissCause::kFound : truth.trace.cause)},
            {"visibility", truth.visibility},
            {"distance_m", truth.camera_from_object.translation().z()},
            {"segmented", truth.trace.segmented},
            {"features", truth.trace.features},
            {"correct_correspondences", truth.trace.correct_correspondences},
            {"best_consensus", truth.trace.best_consensus},
            {"detail", truth.trace.detail}};
  if (hit) {
    j["translation_error_m"] = hit->translation_error;
    j["rotation_error_deg"] = hit->rotation_error;
  }
  return j;
}

json reliabilityJson(const std::map<std::string, ReliabilityBands>& reliability) {
  json list = json::array();
  for (const auto& [source, bands] : reliability)
    for (size_t i = 0; i < kReliabilityBands; ++i) {
      const ReliabilityBands::Band& band = bands.bands[i];
      if (band.detections == 0) continue;
      list.push_back({{"source", source},
                      {"confidence_above", i == 0 ? 0.0 : kReliabilityBandEnds[i - 1]},
                      {"confidence_up_to", kReliabilityBandEnds[i]},
                      {"detections", band.detections},
                      {"mean_confidence", band.confidence_sum / band.detections},
                      {"right", band.right},
                      {"moved", band.moved}});
    }
  return list;
}

json frameJson(const FrameRecord& record, const FrameScore& score) {
  json j = {{"scene", record.scene},
            {"frame", record.frame},
            {"score", score.score},
            {"true_positives", score.hits.size()},
            {"false_negatives", score.missed.size()},
            {"false_positives", score.false_positives.size()},
            {"seconds", record.times.total},
            {"left_out", record.left_out},
            {"instances", json::array()},
            {"wrong", json::array()}};
  std::vector<const Hit*> hit_of(record.truth.size(), nullptr);
  for (const Hit& hit : score.hits) hit_of[static_cast<size_t>(hit.truth)] = &hit;
  for (size_t i = 0; i < record.truth.size(); ++i) j["instances"].push_back(truthJson(record.truth[i], hit_of[i]));
  for (const int d : score.false_positives) {
    const HypothesisRecord& h = record.detections[static_cast<size_t>(d)];
    j["wrong"].push_back(
        {{"object", h.object}, {"confidence", h.confidence}, {"total", h.scores.total}, {"consensus", h.consensus}});
  }
  return j;
}

}  // namespace

std::string reportJson(const Report& report, const std::vector<FrameRecord>& records, const RunInfo& run) {
  json j = tallyJson(report.all);
  j["config"] = run.config;
  j["models"] = run.models;
  j["data"] = run.data;
  j["jobs"] = run.jobs;
  j["frames"] = records.size();
  j["frames_cut_by_budget"] = report.cut_frames;
  j["score"] = report.all.score;
  j["score_percent"] = report.all.scorePercent();
  j["seconds_per_frame"] = {{"median", report.seconds_median}, {"p95", report.seconds_p95}};
  j["cpu_ms_per_frame"] = {{"median", report.cpu.median}, {"mean", report.cpu.mean}, {"p95", report.cpu.p95}};
  const StageTimes& cpu = report.cpu.stage_mean;
  j["stage_cpu_ms"] = {{"segmentation", cpu.segmentation},
                       {"feature_extraction", cpu.feature_extraction},
                       {"hypothesis_generation", cpu.hypothesis_generation},
                       {"reprojection_verification", cpu.reprojection_verification}};
  j["funnel"] = json::object();
  for (const auto& [source, counts] : report.funnel) {
    for (int level = 0; level < kTestLevels; ++level)
      j["funnel"][source][testLevelName(static_cast<TestLevel>(level))] = counts.reached[static_cast<size_t>(level)];
    j["funnel"][source]["accepted"] = counts.accepted;
  }
  j["left_out"] = report.left_out;
  j["reliability"] = reliabilityJson(report.reliability);
  j["covariance"] = {{"poses", report.consistency.poses},
                     {"within_50_percent", report.consistency.within_median},
                     {"within_95_percent", report.consistency.within_95}};
  j["stage_seconds_median"] = {{"segmentation", report.stage_median.segmentation},
                               {"feature_extraction", report.stage_median.feature_extraction},
                               {"hypothesis_generation", report.stage_median.hypothesis_generation},
                               {"reprojection_verification", report.stage_median.reprojection_verification}};
  j["per_object"] = bandsJson(report.per_object, "object");
  j["per_visibility"] = bandsJson(report.per_visibility, "visibility");
  j["per_distance"] = bandsJson(report.per_distance, "distance");
  for (int cause = 0; cause < kMissCauses; ++cause)
    j["causes"][missCauseName(static_cast<MissCause>(cause))] = report.causes[static_cast<size_t>(cause)];
  for (int cause = 0; cause < kFalseCauses; ++cause)
    j["false_causes"][falseCauseName(static_cast<FalseCause>(cause))] = report.false_causes[static_cast<size_t>(cause)];
  j["per_frame"] = json::array();
  for (size_t i = 0; i < records.size(); ++i) j["per_frame"].push_back(frameJson(records[i], report.frames[i]));
  return j.dump(1);
}

}  // namespace recognition
