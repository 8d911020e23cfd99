#include "rgbd_recognition/evaluation/challenge_score.h"

#include <algorithm>

namespace recognition {
namespace {

double ramp(double error, double full, double none) { return std::clamp((none - error) / (none - full), 0.0, 1.0); }

Hit makeHit(int detection, int truth, const Pose& found, const Pose& real) {
  Hit hit;
  hit.detection = detection;
  hit.truth = truth;
  hit.translation_error = translationDistance(found, real);
  hit.rotation_error = rotationDistance(found, real) * 180.0 / M_PI;
  hit.accuracy = 0.5 * rotationScore(hit.rotation_error) + 0.5 * translationScore(hit.translation_error);
  return hit;
}

}  // namespace

double translationScore(double error) { return ramp(error, 0.01, 0.03); }

double rotationScore(double error) { return ramp(error, 2.0, 20.0); }

FrameScore scoreFrame(const std::vector<ScoredInstance>& detections, const std::vector<ScoredInstance>& truth) {
  std::vector<Hit> pairs;
  for (size_t d = 0; d < detections.size(); ++d)
    for (size_t t = 0; t < truth.size(); ++t)
      if (detections[d].object_id == truth[t].object_id)
        pairs.push_back(makeHit(static_cast<int>(d), static_cast<int>(t), detections[d].camera_from_object,
                                truth[t].camera_from_object));
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Hit& a, const Hit& b) { return a.translation_error < b.translation_error; });

  FrameScore result;
  std::vector<bool> used(detections.size(), false), found(truth.size(), false);
  double sum = 0.0;
  for (const Hit& pair : pairs) {
    const auto d = static_cast<size_t>(pair.detection), t = static_cast<size_t>(pair.truth);
    if (used[d] || found[t]) continue;
    used[d] = found[t] = true;
    sum += pair.accuracy;
    result.hits.push_back(pair);
  }
  for (size_t t = 0; t < truth.size(); ++t)
    if (!found[t]) result.missed.push_back(static_cast<int>(t));
  for (size_t d = 0; d < detections.size(); ++d)
    if (!used[d]) result.false_positives.push_back(static_cast<int>(d));
  result.score = 0.5 * std::max(0.0, static_cast<double>(result.hits.size()) - 0.5 * result.missed.size() -
                                         1.0 * result.false_positives.size() + sum);
  return result;
}

}  // namespace recognition
