#include <cstdarg>
#include <cstdio>

#include "rgbd_recognition/evaluation/report.h"

namespace recognition {
namespace {

__attribute__((format(printf, 2, 3))) void append(std::string& out, const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  out += line;
}

void appendTallies(std::string& out, const char* heading, const std::map<std::string, Tally>& tallies) {
  append(out, "\n%-62s %5s %5s %5s %5s %9s %9s %9s\n", heading, "true", "found", "miss", "false", "recall", "precision",
         "accuracy");
  for (const auto& [name, tally] : tallies)
    append(out, "%-62.62s %5d %5d %5d %5d %7.1f %% %7.1f %% %7.1f %%\n", name.c_str(), tally.instances,
           tally.true_positives, tally.false_negatives, tally.false_positives, 100.0 * tally.recall(),
           100.0 * tally.precision(), 100.0 * tally.poseAccuracy());
}

void appendCuts(std::string& out, const Report& report, const std::vector<FrameRecord>& records) {
  constexpr int kMax = 10;
  append(out, "budgets cut something in %d frames\n", report.cut_frames);
  int listed = 0;
  for (const FrameRecord& record : records) {
    if (record.left_out.empty() || ++listed > kMax) continue;
    append(out, "  %06d/%06d:", record.scene, record.frame);
    for (const std::string& what : record.left_out) out += " " + what + ";";
    out += "\n";
  }
}

void appendMisses(std::string& out, const Report& report, const std::vector<FrameRecord>& records) {
  constexpr size_t kMax = 40;
  size_t listed = 0;
  for (size_t i = 0; i < records.size(); ++i) {
    for (const int t : report.frames[i].missed) {
      if (++listed > kMax) continue;
      const TruthRecord& truth = records[i].truth[static_cast<size_t>(t)];
      append(out, "  %06d/%06d %-40.40s %-20s features %d, matched %d, segmented %.0f %% %s\n", records[i].scene,
             records[i].frame, truth.object.c_str(), missCauseName(truth.trace.cause), truth.trace.features,
             truth.trace.correct_correspondences, 100.0 * truth.trace.segmented, truth.trace.detail.c_str());
    }
  }
  if (listed > kMax) append(out, "  ... and %zu more (see report.json)\n", listed - kMax);
}

}  // namespace

std::string reportText(const Report& report, const std::vector<FrameRecord>& records, const RunInfo& run) {
  std::string out;
  const Tally& all = report.all;
  append(out, "%s on %s\n", run.config.c_str(), run.data.c_str());
  append(out, "frames %zu, instances %d: found %d, missed %d, false %d\n", records.size(), all.instances,
         all.true_positives, all.false_negatives, all.false_positives);
  append(out, "precision %.2f %%, recall %.2f %%, pose accuracy %.1f %% (%d of %d within 3 cm and 20 degrees)\n",
         100.0 * all.precision(), 100.0 * all.recall(), 100.0 * all.poseAccuracy(), all.near_truth, all.true_positives);
  append(out, "score %.2f of %d = %.2f %%\n", all.score, all.instances, all.scorePercent());
  const StageTimes& stage = report.stage_median;
  append(
      out,
      "seconds a frame: median %.3f, p95 %.3f (segmentation %.3f, features %.3f, hypotheses %.3f, verification %.3f)\n",
      report.seconds_median, report.seconds_p95, stage.segmentation, stage.feature_extraction,
      stage.hypothesis_generation, stage.reprojection_verification);
  appendCuts(out, report, records);
  appendTallies(out, "object", report.per_object);
  if (report.per_visibility.size() > 1) appendTallies(out, "visibility", report.per_visibility);
  if (report.per_distance.size() > 1) appendTallies(out, "distance", report.per_distance);
  out += "\ncauses:";
  for (int cause = 0; cause < kMissCauses; ++cause)
    append(out, " %s %d", missCauseName(static_cast<MissCause>(cause)), report.causes[static_cast<size_t>(cause)]);
  out += "\n";
  appendMisses(out, report, records);
  for (const FalsePositive& wrong : report.false_positives) {
    const FrameRecord& record = records[static_cast<size_t>(wrong.frame)];
    append(out, "  %06d/%06d FALSE %-40.40s confidence %.2f, total %.2f, consensus %d: %s %s\n", record.scene,
           record.frame, wrong.detection.object.c_str(), wrong.detection.confidence, wrong.detection.scores.total,
           wrong.detection.consensus, falseCauseName(wrong.cause), wrong.taken_for_it.c_str());
  }
  return out;
}

}  // namespace recognition
