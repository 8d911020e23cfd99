#include "rgbd_recognition/evaluation/report.h"

#include <algorithm>
#include <cmath>

#include "evaluation/reliability.h"

namespace recognition {
namespace {

double ratio(double part, double whole, double otherwise) { return whole > 0.0 ? part / whole : otherwise; }

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<size_t>(std::lround(q * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

double stageMedian(const std::vector<FrameRecord>& records, double StageTimes::*stage) {
  std::vector<double> values;
  for (const FrameRecord& record : records) values.push_back(record.times.*stage);
  return quantile(values, 0.5);
}

std::string visibilityBand(double visibility) {
  if (visibility < 0.0) return "not given";
  if (visibility < 0.3) return "0-30 %";
  if (visibility < 0.5) return "30-50 %";
  if (visibility < 0.7) return "50-70 %";
  if (visibility < 0.9) return "70-90 %";
  return "90-100 %";
}

std::string distanceBand(double z) {
  if (z < 0.75) return "0.00-0.75 m";
  if (z < 1.0) return "0.75-1.00 m";
  if (z < 1.25) return "1.00-1.25 m";
  if (z < 1.5) return "1.25-1.50 m";
  return "1.50- m";
}

void addInstance(Tally& tally, const Hit* hit) {
  ++tally.instances;
  if (!hit) {
    ++tally.false_negatives;
    return;
  }
  ++tally.true_positives;
  tally.accuracy_sum += hit->accuracy;
  if (hit->translation_error < kNearTranslation && hit->rotation_error < kNearRotation) ++tally.near_truth;
}

/// By the true instance whose centre is nearest, if it is near enough to touch.
FalsePositive explainFalse(const FrameRecord& record, const HypothesisRecord& detection) {
  constexpr double kTouching = 0.15;  // metres between centres
  FalsePositive wrong;
  wrong.detection = detection;
  double nearest = kTouching;
  for (const TruthRecord& truth : record.truth) {
    const double distance = translationDistance(truth.camera_from_object, detection.camera_from_object);
    if (distance >= nearest) continue;
    nearest = distance;
    const bool same = truth.object_id == detection.object_id;
    wrong.cause = same ? FalseCause::kTwice : FalseCause::kOtherObject;
    wrong.taken_for_it = same ? "" : truth.object;
  }
  return wrong;
}

void addFrame(Report& report, const FrameRecord& record, int index) {
  const FrameScore score = scoreOf(record);
  std::vector<const Hit*> hit_of(record.truth.size(), nullptr);
  for (const Hit& hit : score.hits) hit_of[static_cast<size_t>(hit.truth)] = &hit;
  for (size_t i = 0; i < record.truth.size(); ++i) {
    const TruthRecord& truth = record.truth[i];
    addInstance(report.all, hit_of[i]);
    addInstance(report.per_object[truth.object], hit_of[i]);
    addInstance(report.per_visibility[visibilityBand(truth.visibility)], hit_of[i]);
    addInstance(report.per_distance[distanceBand(truth.camera_from_object.translation().z())], hit_of[i]);
    ++report.causes[static_cast<size_t>(hit_of[i] ? MissCause::kFound : truth.trace.cause)];
  }
  for (const int d : score.false_positives) {
    const HypothesisRecord& detection = record.detections[static_cast<size_t>(d)];
    report.false_positives.push_back(explainFalse(record, detection));
    report.false_positives.back().frame = index;
    ++report.false_causes[static_cast<size_t>(report.false_positives.back().cause)];
    ++report.all.false_positives;
    ++report.per_object[detection.object].false_positives;
  }
  report.cut_frames += record.left_out.empty() ? 0 : 1;
  report.all.score += score.score;
  report.frames.push_back(score);
}

constexpr std::array<double StageTimes::*, 5> kStages = {&StageTimes::segmentation, &StageTimes::feature_extraction,
                                                         &StageTimes::hypothesis_generation,
                                                         &StageTimes::reprojection_verification, &StageTimes::total};

CpuTimes cpuTimes(const std::vector<FrameRecord>& records) {
  CpuTimes cpu;
  std::vector<double> totals;
  for (const FrameRecord& record : records) {
    totals.push_back(1e3 * record.cpu_times.total);
    for (const auto stage : kStages)
      cpu.stage_mean.*stage += 1e3 * record.cpu_times.*stage / static_cast<double>(records.size());
  }
  cpu.mean = cpu.stage_mean.total;
  cpu.median = quantile(totals, 0.5);
  cpu.p95 = quantile(totals, 0.95);
  return cpu;
}

std::map<std::string, SourceFunnel> funnelOf(const std::vector<FrameRecord>& records) {
  std::map<std::string, SourceFunnel> funnel;
  for (const FrameRecord& record : records)
    for (const HypothesisRecord& h : record.hypotheses) {
      SourceFunnel& source = funnel[h.source];
      for (int level = 0; level < kTestLevels; ++level) {
        ++source.reached[static_cast<size_t>(level)];
        if (h.level == testLevelName(static_cast<TestLevel>(level))) break;
      }
      source.accepted += h.rejection == rejectionName(Rejection::kNone) ? 1 : 0;
    }
  return funnel;
}

}  // namespace

double Tally::precision() const { return ratio(true_positives, true_positives + false_positives, 1.0); }
double Tally::recall() const { return ratio(true_positives, instances, 1.0); }
double Tally::poseAccuracy() const { return ratio(accuracy_sum, true_positives, 0.0); }
double Tally::scorePercent() const { return 100.0 * ratio(score, instances, 0.0); }

const char* falseCauseName(FalseCause cause) {
  static constexpr std::array<const char*, kFalseCauses> names = {"twice", "other_object", "background"};
  return names.at(static_cast<size_t>(cause));
}

Report makeReport(const std::vector<FrameRecord>& records) {
  Report report;
  std::vector<double> seconds;
  for (size_t i = 0; i < records.size(); ++i) {
    addFrame(report, records[i], static_cast<int>(i));
    seconds.push_back(records[i].times.total);
  }
  report.cpu = cpuTimes(records);
  report.funnel = funnelOf(records);
  report.reliability = reliabilityOf(records);
  report.consistency = consistencyOf(records);
  for (const FrameRecord& record : records)
    for (const std::string& what : record.left_out) ++report.left_out[what];
  report.seconds_median = quantile(seconds, 0.5);
  report.seconds_p95 = quantile(seconds, 0.95);
  report.stage_median.segmentation = stageMedian(records, &StageTimes::segmentation);
  report.stage_median.feature_extraction = stageMedian(records, &StageTimes::feature_extraction);
  report.stage_median.hypothesis_generation = stageMedian(records, &StageTimes::hypothesis_generation);
  report.stage_median.reprojection_verification = stageMedian(records, &StageTimes::reprojection_verification);
  report.stage_median.total = report.seconds_median;
  return report;
}

}  // namespace recognition
