#include "rgbd_recognition/evaluation/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluation/oracle.h"
#include "evaluation/reliability.h"
#include "evaluation/threshold_sweep.h"

namespace recognition {
namespace {

Pose at(double x) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, 0.0, 1.0);
  return pose;
}

HypothesisRecord hypothesis(int id, double x, double total, int segment, const char* rejection) {
  HypothesisRecord h;
  h.object = "object_" + std::to_string(id);
  h.object_id = id;
  h.camera_from_object = at(x);
  h.scores.total = total;
  h.scores.best_segment = segment;
  h.rejection = rejection;
  return h;
}

TruthRecord truth(int id, double x, MissCause cause) {
  TruthRecord t;
  t.object = "object_" + std::to_string(id);
  t.object_id = id;
  t.camera_from_object = at(x);
  t.trace.cause = cause;
  return t;
}

/// Objects 1 (found) and 2 (refused by the test at total 0.3) are there; 3 is a false positive.
FrameRecord sampleRecord() {
  FrameRecord record;
  record.truth = {truth(1, 0.0, MissCause::kFound), truth(2, 0.3, MissCause::kFailedTest)};
  record.hypotheses = {hypothesis(1, 0.0, 0.8, 1, "none"),
                       hypothesis(2, 0.3, 0.3, 2, rejectionName(Rejection::kConsistency)),
                       hypothesis(3, 0.6, 0.5, 3, "none")};
  record.detections = {record.hypotheses[0], record.hypotheses[2]};
  record.times.total = 0.2;
  return record;
}

TEST(Oracle, CountsWhatBecameOfTruePoses) {
  FrameRecord record = sampleRecord();
  EXPECT_TRUE(oracleBands({record}).empty());
  record.truth[1].visibility = 0.4;
  record.truth[1].oracle = hypothesis(2, 0.3, 0.6, 2, "none");
  const std::vector<OracleBand> bands = oracleBands({record});
  ASSERT_FALSE(bands.empty());
  EXPECT_EQ(bands[0].name, "all");
  EXPECT_EQ(bands[0].count.instances, 2);
  EXPECT_EQ(bands[0].count.missed, 1);
  EXPECT_EQ(bands[0].count.proposed, 1);  // it failed the test
  EXPECT_EQ(bands[0].count.accepted, 1);
  const FrameRecord back = fromJsonLine(toJsonLine(record));
  EXPECT_FALSE(back.truth[0].oracle);
  ASSERT_TRUE(back.truth[1].oracle);
  EXPECT_EQ(back.truth[1].oracle->rejection, "none");
}

TEST(Report, CountsByHand) {
  const Report report = makeReport({sampleRecord()});
  EXPECT_EQ(report.all.true_positives, 1);
  EXPECT_EQ(report.all.false_negatives, 1);
  EXPECT_EQ(report.all.false_positives, 1);
  EXPECT_DOUBLE_EQ(report.all.precision(), 0.5);
  EXPECT_DOUBLE_EQ(report.all.recall(), 0.5);
  EXPECT_DOUBLE_EQ(report.all.score, 0.25);  // 0.5 (1 - 0.5 - 1 + 1)
  EXPECT_EQ(report.causes[static_cast<size_t>(MissCause::kFailedTest)], 1);
  EXPECT_EQ(report.false_positives.at(0).cause, FalseCause::kBackground);
}

TEST(Report, SaysWhatFalseDetectionsLieOn) {
  FrameRecord record = sampleRecord();
  record.detections = {hypothesis(1, 0.0, 0.8, 1, "none"), hypothesis(1, 0.05, 0.8, 1, "none"),
                       hypothesis(3, 0.31, 0.5, 3, "none"), hypothesis(3, 0.9, 0.5, 3, "none")};
  const Report report = makeReport({record});
  ASSERT_EQ(report.false_positives.size(), 3u);
  EXPECT_EQ(report.false_positives[0].cause, FalseCause::kTwice);
  EXPECT_EQ(report.false_positives[1].cause, FalseCause::kOtherObject);
  EXPECT_EQ(report.false_positives[1].taken_for_it, "object_2");
  EXPECT_EQ(report.false_positives[2].cause, FalseCause::kBackground);
  EXPECT_EQ(report.false_causes, (std::array<int, kFalseCauses>{1, 1, 1}));
}

TEST(Report, CountsReliabilityBySource) {
  FrameRecord record = sampleRecord();
  record.detections[0].source = record.detections[1].source = "consensus";
  record.detections[0].confidence = 0.95;
  record.detections[1].confidence = 0.93;  // false
  record.detections.push_back(hypothesis(2, 0.35, 0.8, 2, "none"));
  record.detections[2].source = "shape";  // hits 2, but 5 cm beside it
  record.detections[2].confidence = 0.6;
  const Report report = makeReport({record});
  const ReliabilityBands::Band& sure = report.reliability.at("consensus").bands[2];
  EXPECT_EQ(sure.detections, 2);
  EXPECT_EQ(sure.right, 1);
  EXPECT_EQ(sure.moved, 0);
  EXPECT_NEAR(sure.confidence_sum, 1.88, 1e-12);
  const ReliabilityBands::Band& doubtful = report.reliability.at("shape").bands[0];
  EXPECT_EQ(doubtful.detections, 1);
  EXPECT_EQ(doubtful.right, 0);
  EXPECT_EQ(doubtful.moved, 1);
}

TEST(Report, ComparesErrorsWithTheirCovariance) {
  FrameRecord record = sampleRecord();
  HypothesisRecord& found = record.detections[0];
  found.camera_from_object.translation().x() += 0.01;  // of 1 cm
  found.camera_from_object.rotate(Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitY()));
  found.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
  found.covariance.bottomRightCorner<3, 3>() *= 9.0;  // 0.03 rad: the turn is of two deviations
  const Pose& truth = record.truth[0].camera_from_object;
  EXPECT_NEAR(normalisedError(found.camera_from_object, found.covariance, truth), 1.0 + 4.0, 1e-9);
  EXPECT_LT(normalisedError(found.camera_from_object, Eigen::Matrix<double, 6, 6>::Zero(), truth), 0.0);
  CovarianceConsistency consistency = makeReport({record}).consistency;
  EXPECT_EQ(consistency.poses, 1);  // the other one is false
  EXPECT_EQ(consistency.within_median, 1);
  found.covariance /= 2.0;  // 10
  consistency = makeReport({record}).consistency;
  EXPECT_EQ(consistency.within_median, 0);
  EXPECT_EQ(consistency.within_95, 1);
  EXPECT_TRUE(fromJsonLine(toJsonLine(record)).detections[0].covariance.isApprox(found.covariance));
}

TEST(Report, JsonHasThePromisedKeys) {
  const std::vector<FrameRecord> records = {sampleRecord()};
  const auto j = nlohmann::json::parse(reportJson(makeReport(records), records, {}));
  for (const char* key :
       {"frames", "instances", "true_positives", "false_negatives", "false_positives", "precision", "recall",
        "pose_accuracy", "score_percent", "seconds_per_frame", "per_object", "per_frame", "reliability", "covariance"})
    EXPECT_TRUE(j.contains(key)) << key;
  EXPECT_DOUBLE_EQ(j["seconds_per_frame"]["median"].get<double>(), 0.2);
  EXPECT_DOUBLE_EQ(j["score_percent"].get<double>(), 12.5);
}

TEST(FrameRecord, JsonRoundTrip) {
  const FrameRecord record = sampleRecord();
  const FrameRecord back = fromJsonLine(toJsonLine(record));
  EXPECT_EQ(toJsonLine(back), toJsonLine(record));
  EXPECT_THROW(fromJsonLine("{\"scene\": 1"), std::runtime_error);
}

TEST(ThresholdSweep, DecidesAnewAtEachThreshold) {
  const auto sweep = sweepThreshold({sampleRecord()}, DecisionMeasure::kTotalConsistency, 10);
  ASSERT_EQ(sweep.size(), 11u);
  EXPECT_DOUBLE_EQ(sweep[2].recall, 1.0);  // 0.2: all three
  EXPECT_NEAR(sweep[2].precision, 2.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(sweep[4].recall, 0.5);     // 0.4: 1 and 3
  EXPECT_DOUBLE_EQ(sweep[6].precision, 1.0);  // 0.6: 1 alone
  EXPECT_DOUBLE_EQ(sweep[9].recall, 0.0);     // 0.9: none
}

TEST(ThresholdSweep, OneObjectASegment) {
  FrameRecord record = sampleRecord();
  record.hypotheses[2].scores.best_segment = 1;  // now conflicts with object 1, which is better
  record.hypotheses[2].rejection = rejectionName(Rejection::kConflict);
  record.detections.pop_back();
  const auto sweep = sweepThreshold({record}, DecisionMeasure::kTotalConsistency, 10);
  EXPECT_DOUBLE_EQ(sweep[0].precision, 1.0);
}

TEST(ThresholdSweep, FurtherRoundsHaveHalfTheThreshold) {
  FrameRecord record = sampleRecord();
  record.hypotheses[1].round = 1;  // total 0.3: passes up to 0.6, while round 0 finds something
  const auto sweep = sweepThreshold({record}, DecisionMeasure::kTotalConsistency, 10);
  EXPECT_DOUBLE_EQ(sweep[6].recall, 1.0);
  EXPECT_DOUBLE_EQ(sweep[7].recall, 0.5);
  record.hypotheses[0].scores.total = record.detections[0].scores.total = 0.5;
  EXPECT_DOUBLE_EQ(sweepThreshold({record}, DecisionMeasure::kTotalConsistency, 10)[6].recall, 0.0);
}

TEST(ThresholdSweep, OrTheSameThresholdInAllRounds) {
  FrameRecord record = sampleRecord();
  record.hypotheses[1].round = 1;  // total 0.3
  const auto sweep = sweepThreshold({record}, DecisionMeasure::kTotalConsistencyAllRounds, 10);
  EXPECT_DOUBLE_EQ(sweep[2].recall, 1.0);
  EXPECT_DOUBLE_EQ(sweep[4].recall, 0.5);
}

TEST(ThresholdSweep, ConflictsStayDecidedWhileTheWinnerStands) {
  FrameRecord record = sampleRecord();
  record.hypotheses[1].rejection = rejectionName(Rejection::kConflict);
  record.hypotheses[1].conflict_with = "object_3";
  record.hypotheses[1].scores.total = 0.9;
  const auto sweep = sweepThreshold({record}, DecisionMeasure::kTotalConsistency, 10);
  EXPECT_DOUBLE_EQ(sweep[5].recall, 0.5);  // 3 stands, and 2 loses to it
  EXPECT_DOUBLE_EQ(sweep[6].recall, 1.0);  // 3 is gone
}

TEST(ThresholdSweep, GivesTheRunsDetectionsAtItsThreshold) {
  FrameRecord record = sampleRecord();
  HypothesisRecord taken_back = hypothesis(2, 0.3, 0.7, 4, "none");  // accepted first, then lost to the one of round 1
  HypothesisRecord later = hypothesis(2, 0.6, 0.25, 5, "none");
  later.round = 1;
  record.hypotheses.push_back(taken_back);
  record.hypotheses.push_back(later);
  record.detections.push_back(later);
  const SweepPoint point = sweepThreshold({record}, DecisionMeasure::kTotalConsistency, 10)[4];
  const Report report = makeReport({record});
  EXPECT_DOUBLE_EQ(point.score_percent, report.all.scorePercent());
  EXPECT_DOUBLE_EQ(point.precision, report.all.precision());
}

}  // namespace
}  // namespace recognition
