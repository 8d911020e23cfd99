#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/evaluation/challenge_score.h"
#include "rgbd_recognition/evaluation/miss_cause.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {

/// A hypothesis as kept for the report: enough to score it and to choose again with another threshold.
struct HypothesisRecord {
  std::string object;
  int object_id = -1;
  Pose camera_from_object = Pose::Identity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< as VerifiedHypothesis::covariance
  ConsistencyScores scores;
  Evidence evidence;
  double confidence = 0.0;
  int consensus = 0;
  std::string source;  ///< sourceName()
  std::string level;   ///< testLevelName()
  int round = 0;
  std::string rejection;      ///< "none": accepted
  std::string conflict_with;  ///< object that won, where it lost a conflict
};

struct TruthRecord {
  int object_id = 0;
  std::string object;  ///< its model's name, "" if not trained
  Pose camera_from_object = Pose::Identity();
  double visibility = -1.0;
  InstanceTrace trace;
  std::optional<HypothesisRecord> oracle;  ///< the true pose, tested as if it had been proposed
};

/// All that is kept of one evaluated frame; one line of frames.jsonl.
struct FrameRecord {
  int scene = 0;
  int frame = 0;
  StageTimes times;
  StageTimes cpu_times;
  std::vector<std::string> left_out;  ///< by the budgets of matching and search, in words
  int rounds = 0;
  int features = 0;
  std::vector<TruthRecord> truth;
  std::vector<HypothesisRecord> detections;
  std::vector<HypothesisRecord> hypotheses;
};

/// The challenge's score of what was found against what is true.
FrameScore scoreOf(const FrameRecord& record);

struct FrameEvaluation {
  bool only_trained = false;  ///< leave out true instances of objects that the database does not have
  bool oracle = false;        ///< test the pose of each missed instance: TruthRecord::oracle
};

/// Runs the recognizer on a frame and keeps what the report needs. Throws std::runtime_error that names the object if
/// the database lacks one, unless `only_trained`.
FrameRecord evaluateFrame(Recognizer& recognizer, const BopFrame& source, const FrameEvaluation& options);

/// One line of JSON, and back (throws std::runtime_error).
std::string toJsonLine(const FrameRecord& record);
FrameRecord fromJsonLine(const std::string& line);

}  // namespace recognition
