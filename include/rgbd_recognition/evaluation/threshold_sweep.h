#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/evaluation/frame_record.h"

namespace rgbd_recognition {

/// The set's figures had the decision threshold been another (Fig. 6).
struct SweepPoint {
  double threshold = 0.0;
  double score_percent = 0.0;
  double precision = 0.0;  ///< 0..1
  double recall = 0.0;     ///< 0..1
};

/// What the threshold is compared with.
enum class DecisionMeasure { kTotalConsistency, kConfidence };

/// Thresholds 0, 1/steps, .. 1 from records made once: at each, the hypotheses of the first round that the test itself refused or passed are decided anew
/// (highest measure first; one object a segment S*, no instance of an object twice in a place). Further rounds are not repeated.
std::vector<SweepPoint> sweepThreshold(const std::vector<FrameRecord>& records, DecisionMeasure measure, int steps = 50);

/// threshold,score_percent,precision,recall
std::string sweepCsv(const std::vector<SweepPoint>& sweep);

/// One run's curves with its name; `chosen` is the threshold in use.
struct NamedSweep {
  std::string name;
  std::vector<SweepPoint> points;
  double chosen = 0.0;
};

/// Fig. 6: score over threshold (left) and precision over recall (right), one colour a run. CV_8UC3.
cv::Mat drawSweeps(const std::vector<NamedSweep>& sweeps);

}  // namespace rgbd_recognition
