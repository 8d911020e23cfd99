#include "evaluation/report_markdown.h"
#include "evaluation/oracle.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include "rgbd_recognition/annotation.h"
#include "core/image_file.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr size_t kWorstFrames = 6;

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

void writeSummary(std::ostream& out, const std::vector<MarkdownRun>& runs) {
  out << "| config | frames | instances | found | missed | false | precision | recall | pose accuracy | score | "
         "s/frame (median, p95) | frames cut by a budget |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const MarkdownRun& run : runs) {
    const Tally& t = run.report.all;
    out << "| " << run.info.config << " | " << run.records.size() << " | " << t.instances << " | " << t.true_positives
        << " | " << t.false_negatives << " | " << t.false_positives << " | " << number(100 * t.precision(), 2)
        << " % | " << number(100 * t.recall(), 2) << " % | " << number(100 * t.poseAccuracy(), 1) << " % | "
        << number(t.scorePercent(), 2) << " % | " << number(run.report.seconds_median, 3) << ", "
        << number(run.report.seconds_p95, 3) << " | " << run.report.cut_frames << " |\n";
  }
}

/// One row a run of counts under their names.
template <typename Counts>
void writeCounts(std::ostream& out, const std::vector<MarkdownRun>& runs, int count, const char* (*name)(int),
                 const Counts& counts) {
  out << "\n| config |";
  for (int c = 0; c < count; ++c) out << " " << name(c) << " |";
  out << "\n| --- |";
  for (int c = 0; c < count; ++c) out << " --- |";
  for (const MarkdownRun& run : runs) {
    out << "\n| " << run.info.config << " |";
    for (const int n : counts(run.report)) out << " " << n << " |";
  }
  out << "\n";
}

void writeCauses(std::ostream& out, const std::vector<MarkdownRun>& runs) {
  out << "\n## Where instances are lost\n";
  writeCounts(
      out, runs, kMissCauses, [](int c) { return missCauseName(static_cast<MissCause>(c)); },
      [](const Report& report) { return report.causes; });
  out << "\n## What false detections lie on\n";
  writeCounts(
      out, runs, kFalseCauses, [](int c) { return falseCauseName(static_cast<FalseCause>(c)); },
      [](const Report& report) { return report.false_causes; });
}

void writeBands(std::ostream& out, const std::string& title, const std::map<std::string, Tally>& tallies,
                bool with_false) {
  out << "\n## " << title << "\n\n| | instances | found | missed | recall | pose accuracy |"
      << (with_false ? " false | precision |" : "") << "\n| --- | --- | --- | --- | --- | --- |"
      << (with_false ? " --- | --- |" : "") << "\n";
  for (const auto& [name, t] : tallies) {
    out << "| " << name << " | " << t.instances << " | " << t.true_positives << " | " << t.false_negatives << " | "
        << number(100 * t.recall(), 1) << " % | " << number(100 * t.poseAccuracy(), 1) << " % |";
    if (with_false) out << " " << t.false_positives << " | " << number(100 * t.precision(), 1) << " % |";
    out << "\n";
  }
}

/// What would have become of the missed ones' true poses.
void writeOracle(std::ostream& out, const MarkdownRun& run) {
  const std::vector<OracleBand> bands = oracleBands(run.records);
  if (bands.empty()) return;
  out << "\n## True poses of missed instances (" << run.info.config
      << ")\n\n| | instances | missed | proposed | true pose accepted |\n| --- | --- | --- | --- | --- |\n";
  for (const auto& [name, count] : bands)
    out << "| " << name << " | " << count.instances << " | " << count.missed << " | " << count.proposed << " | "
        << count.accepted << " |\n";
}

void writeReliability(std::ostream& out, const MarkdownRun& run) {
  out << "\n## Reliability by source (" << run.info.config
      << ")\n\n| source | confidence | detections | right | rotated or shifted | false |\n| --- | --- | --- | --- | "
         "--- | --- "
         "|\n";
  for (const auto& [source, bands] : run.report.reliability)
    for (size_t i = 0; i < kReliabilityBands; ++i) {
      const ReliabilityBands::Band& band = bands.bands[i];
      if (band.detections == 0) continue;
      out << "| " << source << " | " << (i == 0 ? "up to " : number(kReliabilityBandEnds[i - 1], 1) + " to ")
          << number(kReliabilityBandEnds[i], 1) << " | " << band.detections << " | " << band.right << " | "
          << band.moved << " | " << band.detections - band.right - band.moved << " |\n";
    }
  const CovarianceConsistency& c = run.report.consistency;
  if (c.poses == 0) return;
  out << "\nRight is within 3 cm and 20 degrees. Errors of these " << c.poses
      << " poses lie within the covariance's 50 % in " << number(100.0 * c.within_median / c.poses, 0)
      << " %, within its 95 % in " << number(100.0 * c.within_95 / c.poses, 0)
      << " % (chi-square, six degrees of freedom).\n";
}

/// Frames by how much of their possible score they lost.
std::vector<size_t> worstFrames(const MarkdownRun& run) {
  std::vector<size_t> order(run.records.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto loss = [&](size_t i) {
    return static_cast<double>(run.records[i].truth.size()) - run.report.frames[i].score +
           static_cast<double>(run.report.frames[i].false_positives.size());
  };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return loss(a) > loss(b); });
  while (!order.empty() && loss(order.back()) < 0.05) order.pop_back();
  if (order.size() > kWorstFrames) order.resize(kWorstFrames);
  return order;
}

cv::Mat drawFrame(const BopFrame& source, const FrameRecord& record, const FrameScore& score,
                  const ModelDatabase& database) {
  const RgbdFrame frame = loadBopFrame(source);
  cv::Mat image = bgrCopy(frame);
  std::vector<Annotation> annotations;
  const auto add = [&](const std::string& object, const Pose& pose, const std::string& note) {
    const int index = database.find(object);
    if (index >= 0) annotations.push_back({index, pose, note + object});
  };
  for (const HypothesisRecord& d : record.detections) add(d.object, d.camera_from_object, "");
  for (const int t : score.missed)
    add(record.truth[static_cast<size_t>(t)].object, record.truth[static_cast<size_t>(t)].camera_from_object,
        "MISSED ");
  for (const int d : score.false_positives)
    add(record.detections[static_cast<size_t>(d)].object, record.detections[static_cast<size_t>(d)].camera_from_object,
        "FALSE ");
  drawAnnotations(image, annotations, database, frame.color_camera);
  return image;
}

void writeWorst(std::ostream& out, const fs::path& directory, const MarkdownRun& run,
                const std::vector<BopFrame>& frames, const ModelDatabase& database) {
  const std::string folder = "worst/" + fs::path(run.info.config).stem().string();
  fs::create_directories(directory / folder);
  out << "\n## Worst frames (" << run.info.config << ")\n";
  for (const size_t i : worstFrames(run)) {
    const FrameScore& score = run.report.frames[i];
    const std::string file =
        folder + "/" + std::to_string(run.records[i].scene) + "_" + std::to_string(run.records[i].frame) + ".jpg";
    writeImage((directory / file).string(), drawFrame(frames[i], run.records[i], score, database));
    out << "\n"
        << frames[i].name() << ": score " << number(score.score, 2) << " of " << run.records[i].truth.size() << "\n\n";
    for (const int t : score.missed) {
      const TruthRecord& truth = run.records[i].truth[static_cast<size_t>(t)];
      out << "- missed " << truth.object << ": " << missCauseName(truth.trace.cause) << " " << truth.trace.detail
          << "\n";
    }
    for (const FalsePositive& wrong : run.report.false_positives)
      if (wrong.frame == static_cast<int>(i))
        out << "- false " << wrong.detection.object << ": " << falseCauseName(wrong.cause) << " " << wrong.taken_for_it
            << "\n";
    out << "\n![" << frames[i].name() << "](" << file << ")\n";
  }
}

}  // namespace

void writeMarkdownReport(const std::string& directory, const std::vector<MarkdownRun>& runs,
                         const std::vector<BopFrame>& frames, const ModelDatabase& database) {
  const fs::path file = fs::path(directory) / "report.md";
  std::ofstream out(file);
  out << "# Recognition on " << (runs.empty() ? "" : runs.front().info.data) << "\n\n";
  writeSummary(out, runs);
  writeCauses(out, runs);
  out << "\n## Decision threshold (Fig. 6)\n\n![score over threshold, precision over recall](sweep.png)\n";
  for (const MarkdownRun& run : runs) {
    writeBands(out, "Objects (" + run.info.config + ")", run.report.per_object, true);
    writeBands(out, "Visibility (" + run.info.config + ")", run.report.per_visibility, false);
    writeBands(out, "Distance (" + run.info.config + ")", run.report.per_distance, false);
    writeReliability(out, run);
    writeOracle(out, run);
  }
  for (const MarkdownRun& run : runs) writeWorst(out, directory, run, frames, database);
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace recognition
