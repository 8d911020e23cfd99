#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/evaluation/frame_record.h"

namespace recognition {

/// The set's figures had the decision threshold been another (Fig. 6).
struct SweepPoint {
  double threshold = 0.0;
  double score_percent = 0.0;
  double precision = 0.0;  ///< 0..1
  double recall = 0.0;     ///< 0..1
};

/// What the threshold is compared with.
enum class DecisionMeasure {
  kTotalConsistency,           ///< the paper's decision: theta_c, and half of it in further rounds
  kTotalConsistencyAllRounds,  ///< theta_c in all rounds: FurtherRounds::kCandidates
  kConfidence                  ///< ours: min_confidence, in all rounds
};

/// Thresholds 0, 1/steps, .. 1 from records made once. At each, the hypotheses that the test or the choice among them
/// decided on are decided anew, round by round while a round finds something; one object a segment S*, no instance of
/// an object twice in a place, and what lost a conflict with a detection loses it as long as that detection stands. At
/// the threshold in use this gives the detections of the run. Not repeated, as it would take a run a threshold:
/// hypotheses of further rounds that other detections would have left.
std::vector<SweepPoint> sweepThreshold(const std::vector<FrameRecord>& records, DecisionMeasure measure,
                                       int steps = 50);

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

}  // namespace recognition
