#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/challenge_score.h"
#include "rgbd_recognition/evaluation/frame_record.h"

namespace recognition {

/// Counts of a set of instances with the challenge's figures over them.
struct Tally {
  int instances = 0;
  int true_positives = 0;
  int false_negatives = 0;
  int false_positives = 0;
  int near_truth = 0;         ///< true positives within 3 cm and 20 degrees
  double accuracy_sum = 0.0;  ///< of the true positives
  double score = 0.0;         ///< sum of frame scores (only meaningful for whole frames)

  double precision() const;     ///< 0..1; 1 where nothing was detected
  double recall() const;        ///< 0..1; 1 where there was nothing to find
  double poseAccuracy() const;  ///< 0..1, of the true positives
  double scorePercent() const;  ///< 100 * score / instances
};

/// What a wrong detection was made of.
enum class FalseCause {
  kTwice,        ///< lies on a true instance of its object that another detection hit
  kOtherObject,  ///< lies on another object that is known
  kBackground,   ///< lies on none
};
constexpr int kFalseCauses = 3;

/// "twice", "other_object", "background"
const char* falseCauseName(FalseCause cause);

/// A detection that was wrong.
struct FalsePositive {
  int frame = 0;  ///< index in the records
  HypothesisRecord detection;
  FalseCause cause = FalseCause::kBackground;
  std::string taken_for_it;  ///< object that is there in truth, for kOtherObject
};

/// CPU time of the process a frame, milliseconds; models are loaded and prepared before. Only meaningful for frames that
/// ran one at a time.
struct CpuTimes {
  double median = 0.0, mean = 0.0, p95 = 0.0;
  StageTimes stage_mean;
};

/// How far the hypotheses of one source came.
struct SourceFunnel {
  std::array<int, kTestLevels> reached{};  ///< by TestLevel; the first are all that were proposed
  int accepted = 0;
};

constexpr size_t kReliabilityBands = 3;
constexpr std::array<double, kReliabilityBands> kReliabilityBandEnds = {0.7, 0.9, 1.0};

/// Detections of one source by confidence: up to the first of kReliabilityBandEnds, above it up to the next, ...
struct ReliabilityBands {
  struct Band {
    int detections = 0;
    int right = 0;  ///< within 3 cm and 20 degrees of a true instance of the object
    int moved = 0;  ///< hit one, but beyond that: rotated mostly; the others are false
    double confidence_sum = 0.0;
  };
  std::array<Band, kReliabilityBands> bands;
};

/// Whether errors of right poses are as large as their covariances say: e^T C^-1 e against a chi-square with six degrees
/// of freedom.
struct CovarianceConsistency {
  int poses = 0;
  int within_median = 0;  ///< of these: half, if the covariance is right
  int within_95 = 0;      ///< below the 95 % quantile
};

struct Report {
  Tally all;
  std::map<std::string, Tally> per_object;       ///< by name
  std::map<std::string, Tally> per_visibility;   ///< "30-50 %", ...; without false positives
  std::map<std::string, Tally> per_distance;     ///< "0.5-1.0 m", ...; without false positives
  std::array<int, kMissCauses> causes{};         ///< of all instances, by MissCause
  std::array<int, kFalseCauses> false_causes{};  ///< of all false positives, by FalseCause
  int cut_frames = 0;                            ///< frames in which a budget left something out
  std::vector<FrameScore> frames;                ///< same order as the records
  std::vector<FalsePositive> false_positives;
  double seconds_median = 0.0;
  double seconds_p95 = 0.0;
  StageTimes stage_median;
  CpuTimes cpu;
  std::map<std::string, SourceFunnel> funnel;           ///< by sourceName(), over all frames
  std::map<std::string, int> left_out;                  ///< what the budget cut, with the number of frames
  std::map<std::string, ReliabilityBands> reliability;  ///< by sourceName()
  CovarianceConsistency consistency;
};

Report makeReport(const std::vector<FrameRecord>& records);

/// Names of the run, for the documents.
struct RunInfo {
  std::string config;
  std::string models;
  std::string data;
  int jobs = 1;
};

/// The document of DIR/report.json.
std::string reportJson(const Report& report, const std::vector<FrameRecord>& records, const RunInfo& run);
/// The readable summary for standard output.
std::string reportText(const Report& report, const std::vector<FrameRecord>& records, const RunInfo& run);

}  // namespace recognition
