#include "evaluation/threshold_sweep.h"

#include <algorithm>
#include <cstdio>

#include "rgbd_recognition/evaluation/challenge_score.h"

namespace recognition {
namespace {

constexpr double kSameInstance = 0.03;  // metres: two poses of one object this near are one instance
constexpr double kFurtherRounds = 0.5;  // of theta_c

double measureOf(const HypothesisRecord& h, DecisionMeasure measure) {
  return measure == DecisionMeasure::kConfidence ? h.confidence : h.scores.total;
}

double thresholdOf(int round, double threshold, DecisionMeasure measure) {
  return round > 0 && measure == DecisionMeasure::kTotalConsistency ? kFurtherRounds * threshold : threshold;
}

/// Rejections that the threshold or the choice among hypotheses made; geometry's own stay.
bool decidable(const HypothesisRecord& h) {
  const auto is = [&](Rejection rejection) { return h.rejection == rejectionName(rejection); };
  return is(Rejection::kNone) || is(Rejection::kConsistency) || is(Rejection::kConflict) || is(Rejection::kDuplicate);
}

/// A hypothesis with what the run made of it.
struct Candidate {
  const HypothesisRecord* hypothesis;
  bool detected;
};

bool passed(const HypothesisRecord& h) { return h.rejection == rejectionName(Rejection::kNone); }

bool excludes(const Candidate& winner, const Candidate& other) {
  if (other.detected) return false;
  const HypothesisRecord& a = *winner.hypothesis;
  const HypothesisRecord& b = *other.hypothesis;
  const bool same_segment = a.scores.best_segment >= 1 && a.scores.best_segment == b.scores.best_segment;
  const bool same_place = translationDistance(a.camera_from_object, b.camera_from_object) < kSameInstance;
  const bool took_back = passed(b) && a.round > b.round;  // b passed, and is no detection
  return same_segment || same_place || (winner.detected && (b.conflict_with == a.object || took_back));
}

bool isDetection(const FrameRecord& record, const HypothesisRecord& h) {
  return std::any_of(record.detections.begin(), record.detections.end(), [&](const HypothesisRecord& d) {
    return d.object_id == h.object_id && d.round == h.round &&
           d.camera_from_object.isApprox(h.camera_from_object, 1e-9);
  });
}

/// The run's detections first, as they won their conflicts; then by falling measure.
std::vector<Candidate> rank(const FrameRecord& record, DecisionMeasure measure) {
  std::vector<Candidate> ranked;
  for (const HypothesisRecord& d : record.detections) ranked.push_back({&d, true});
  for (const HypothesisRecord& h : record.hypotheses)
    if (decidable(h) && !isDetection(record, h)) ranked.push_back({&h, false});
  std::stable_sort(ranked.begin(), ranked.end(), [&](const Candidate& a, const Candidate& b) {
    if (a.detected != b.detected) return a.detected;
    return measureOf(*a.hypothesis, measure) > measureOf(*b.hypothesis, measure);
  });
  return ranked;
}

std::vector<ScoredInstance> decide(const std::vector<Candidate>& ranked, double threshold, DecisionMeasure measure) {
  const auto passes = [&](const Candidate& c) {
    return measureOf(*c.hypothesis, measure) >= thresholdOf(c.hypothesis->round, threshold, measure);
  };
  std::vector<Candidate> winners;  // the detections that stand, whatever their round, then what is accepted beside them
  for (const Candidate& c : ranked)
    if (c.detected && passes(c)) winners.push_back(c);
  std::vector<ScoredInstance> result;
  bool found = true;
  for (int round = 0; found; ++round) {
    found = false;
    for (const Candidate& c : ranked) {
      if (c.hypothesis->round != round || !passes(c)) continue;
      found = found || passed(*c.hypothesis);
      const auto beats = [&](const Candidate& winner) { return excludes(winner, c); };
      if (std::any_of(winners.begin(), winners.end(), beats)) continue;
      found = true;
      if (!c.detected) winners.push_back(c);
      result.push_back({c.hypothesis->object_id, c.hypothesis->camera_from_object});
    }
  }
  return result;
}

}  // namespace

std::vector<SweepPoint> sweepThreshold(const std::vector<FrameRecord>& records, DecisionMeasure measure, int steps) {
  std::vector<SweepPoint> sweep;
  for (int step = 0; step <= steps; ++step) {
    SweepPoint point;
    point.threshold = static_cast<double>(step) / steps;
    double score = 0.0, hits = 0.0, wrong = 0.0, instances = 0.0;
    for (const FrameRecord& record : records) {
      std::vector<ScoredInstance> truth;
      for (const TruthRecord& t : record.truth) truth.push_back({t.object_id, t.camera_from_object});
      const FrameScore frame = scoreFrame(decide(rank(record, measure), point.threshold, measure), truth);
      score += frame.score;
      hits += static_cast<double>(frame.hits.size());
      wrong += static_cast<double>(frame.false_positives.size());
      instances += static_cast<double>(truth.size());
    }
    point.score_percent = instances > 0 ? 100.0 * score / instances : 0.0;
    point.precision = hits + wrong > 0 ? hits / (hits + wrong) : 1.0;
    point.recall = instances > 0 ? hits / instances : 1.0;
    sweep.push_back(point);
  }
  return sweep;
}

std::string sweepCsv(const std::vector<SweepPoint>& sweep) {
  std::string out = "threshold,score_percent,precision,recall\n";
  for (const SweepPoint& p : sweep) {
    char line[96];
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.5f,%.5f\n", p.threshold, p.score_percent, p.precision, p.recall);
    out += line;
  }
  return out;
}

}  // namespace recognition
