#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/report.h"
#include "evaluation/threshold_sweep.h"

namespace recognition {

/// One configuration's run over a split.
struct MarkdownRun {
  RunInfo info;
  std::vector<FrameRecord> records;
  Report report;
  NamedSweep sweep;
};

/// Writes DIR/report.md (all runs side by side, causes, Fig. 6, per object, visibility and distance) with pictures of
/// each run's worst frames under DIR/worst/RUN/: what was found by name, "MISSED" true instances and "FALSE"
/// detections. `frames` are the records' frames. Throws std::runtime_error.
void writeMarkdownReport(const std::string& directory, const std::vector<MarkdownRun>& runs,
                         const std::vector<BopFrame>& frames, const ModelDatabase& database);

}  // namespace recognition
