#include "rgbd_recognition/evaluation/threshold_sweep.h"

#include <algorithm>
#include <cstdio>

#include "rgbd_recognition/evaluation/challenge_score.h"

namespace rgbd_recognition {
namespace {

/// Two poses of one object this near (metres) are one instance.
constexpr double kSameInstance = 0.03;

double measureOf(const HypothesisRecord& h, DecisionMeasure measure) {
  return measure == DecisionMeasure::kConfidence ? h.confidence : h.scores.total;
}

/// Rejections that the threshold or the choice among hypotheses made; geometry's own stay.
bool decidable(const HypothesisRecord& h) {
  const auto is = [&](Rejection rejection) { return h.rejection == rejectionName(rejection); };
  return is(Rejection::kNone) || is(Rejection::kConsistency) || is(Rejection::kConflict) || is(Rejection::kDuplicate);
}

bool excludes(const HypothesisRecord& winner, const HypothesisRecord& other) {
  const bool same_segment = winner.scores.best_segment >= 1 && winner.scores.best_segment == other.scores.best_segment;
  const bool same_place = translationDistance(winner.camera_from_object, other.camera_from_object) < kSameInstance;
  return same_segment || same_place;
}

std::vector<ScoredInstance> decide(std::vector<const HypothesisRecord*> ranked, double threshold, DecisionMeasure measure) {
  std::vector<const HypothesisRecord*> accepted;
  std::vector<ScoredInstance> result;
  for (const HypothesisRecord* h : ranked) {
    if (measureOf(*h, measure) < threshold) break;
    if (std::any_of(accepted.begin(), accepted.end(), [&](const HypothesisRecord* a) { return excludes(*a, *h); })) continue;
    accepted.push_back(h);
    result.push_back({h->object_id, h->camera_from_object});
  }
  return result;
}

std::vector<const HypothesisRecord*> rank(const FrameRecord& record, DecisionMeasure measure) {
  std::vector<const HypothesisRecord*> ranked;
  for (const HypothesisRecord& h : record.hypotheses)
    if (h.round == 0 && decidable(h)) ranked.push_back(&h);
  std::stable_sort(ranked.begin(), ranked.end(), [&](const HypothesisRecord* a, const HypothesisRecord* b) {
    return measureOf(*a, measure) > measureOf(*b, measure);
  });
  return ranked;
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

}  // namespace rgbd_recognition
