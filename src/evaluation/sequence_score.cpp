#include "evaluation/sequence_score.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace recognition {
namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;
constexpr double kTight = 0.01, kTightAngle = 2.0;  // metres, degrees
constexpr double kLoose = 0.03, kLooseAngle = 20.0;
constexpr double kNear = 0.10;                       // metres between centres up to which an answer is of that instance
constexpr double kStill = 2e-4, kStillAngle = 0.02;  // metres and degrees from frame to frame
constexpr double kSettling = 1.0;                    // seconds after a first pose, or a motion, before jitter counts

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

/// Index of the answer to each true instance, the nearest first; -1: none.
std::vector<int> answersTo(const SequenceFrame& frame) {
  struct Pair {
    double distance;
    int truth, answer;
  };
  std::vector<Pair> pairs;
  for (size_t t = 0; t < frame.truth.size(); ++t)
    for (size_t a = 0; a < frame.answers.size(); ++a) {
      const SequenceAnswer& answer = frame.answers[a];
      if (answer.object_id != frame.truth[t].object_id) continue;
      const double distance =
          (answer.camera_from_object * answer.centre - frame.truth[t].camera_from_object * answer.centre).norm();
      if (distance <= kNear) pairs.push_back({distance, static_cast<int>(t), static_cast<int>(a)});
    }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<int> answers(frame.truth.size(), -1);
  std::set<int> taken;
  for (const Pair& pair : pairs) {
    int& answer = answers[static_cast<size_t>(pair.truth)];
    if (answer < 0 && taken.insert(pair.answer).second) answer = pair.answer;
  }
  return answers;
}

/// Poses of a standing object as they are told, in its own true frame.
struct Standing {
  std::vector<Eigen::Vector3d> places, turns;

  /// Adds the squared deviations from the mean.
  void addTo(double* translation, double* rotation, int* count) const {
    if (places.size() < 2) return;
    const double n = static_cast<double>(places.size());
    const auto spread = [n](const std::vector<Eigen::Vector3d>& values) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& value : values) mean += value / n;
      double sum = 0.0;
      for (const Eigen::Vector3d& value : values) sum += (value - mean).squaredNorm();
      return sum;
    };
    *translation += spread(places);
    *rotation += spread(turns);
    *count += static_cast<int>(places.size());
  }
};

/// One true instance over a film.
class Instance {
 public:
  void add(const GroundTruth& truth, const SequenceAnswer* answer, double stamp, double min_visibility,
           SequenceScore* score) {
    const bool visible = truth.visibility < 0.0 || truth.visibility >= min_visibility;
    if (seen_before_ && (translationDistance(truth.camera_from_object, before_) > kStill ||
                         kDegrees * rotationDistance(truth.camera_from_object, before_) > kStillAngle))
      unsettle(stamp);
    before_ = truth.camera_from_object;
    seen_before_ = true;
    if (visible && first_visible_ < 0.0) first_visible_ = stamp;
    score->visible += visible ? 1 : 0;
    if (!answer) return unsettle(stamp);
    if (number_ >= 0 && answer->instance != number_) ++score->switches;
    number_ = answer->instance;
    const double distance = translationDistance(answer->camera_from_object, truth.camera_from_object);
    const double angle = kDegrees * rotationDistance(answer->camera_from_object, truth.camera_from_object);
    const bool loose = distance <= kLoose && angle <= kLooseAngle;
    if (visible) {
      score->loose += loose ? 1 : 0;
      score->tight += distance <= kTight && angle <= kTightAngle ? 1 : 0;
    }
    if (loose && first_visible_ >= 0.0 && !found_) {
      found_ = true;
      score->first_pose.push_back(stamp - first_visible_);
    }
    if (!visible || stamp - unsettled_ < kSettling) return;
    const Pose off = truth.camera_from_object.inverse() * answer->camera_from_object;
    const Eigen::AngleAxisd turn(off.linear());
    runs_.back().places.push_back(off.translation());
    runs_.back().turns.push_back(turn.angle() * turn.axis());
  }

  void finish(double* translation, double* rotation, SequenceScore* score) const {
    if (first_visible_ >= 0.0 && !found_) ++score->never_found;
    for (const Standing& run : runs_) run.addTo(translation, rotation, &score->standing);
  }

 private:
  void unsettle(double stamp) {
    unsettled_ = stamp;
    if (!runs_.back().places.empty()) runs_.emplace_back();
  }

  std::vector<Standing> runs_ = std::vector<Standing>(1);
  Pose before_ = Pose::Identity();
  bool seen_before_ = false, found_ = false;
  double first_visible_ = -1.0, unsettled_ = -1e9;
  int number_ = -1;
};

}  // namespace

SequenceScore scoreSequence(const std::vector<SequenceFrame>& film, double min_visibility) {
  SequenceScore score;
  std::vector<Instance> instances;
  std::set<std::pair<int, int>> false_numbers;
  for (const SequenceFrame& frame : film) {
    ++score.frames;
    score.seconds.push_back(frame.seconds);
    instances.resize(std::max(instances.size(), frame.truth.size()));
    const std::vector<int> answers = answersTo(frame);
    for (size_t i = 0; i < frame.truth.size(); ++i) {
      const SequenceAnswer* answer = answers[i] < 0 ? nullptr : &frame.answers[static_cast<size_t>(answers[i])];
      instances[i].add(frame.truth[i], answer, frame.stamp, min_visibility, &score);
    }
    for (size_t a = 0; a < frame.answers.size(); ++a) {
      if (std::find(answers.begin(), answers.end(), static_cast<int>(a)) != answers.end()) continue;
      ++score.false_frames;
      false_numbers.insert({frame.answers[a].object_id, frame.answers[a].instance});
    }
  }
  score.false_tracks = static_cast<int>(false_numbers.size());
  double translation = 0.0, rotation = 0.0;
  for (const Instance& instance : instances) instance.finish(&translation, &rotation, &score);
  if (score.standing > 0) {
    score.jitter_translation = std::sqrt(translation / score.standing);
    score.jitter_rotation = kDegrees * std::sqrt(rotation / score.standing);
  }
  return score;
}

void SequenceScore::add(const SequenceScore& film) {
  const double before = standing, more = film.standing, both = std::max(1.0, before + more);
  const auto joined = [&](double a, double b) { return std::sqrt((before * a * a + more * b * b) / both); };
  jitter_translation = joined(jitter_translation, film.jitter_translation);
  jitter_rotation = joined(jitter_rotation, film.jitter_rotation);
  for (const auto& [own, other] : {std::make_pair(&frames, film.frames),
                                   {&visible, film.visible},
                                   {&tight, film.tight},
                                   {&loose, film.loose},
                                   {&standing, film.standing},
                                   {&never_found, film.never_found},
                                   {&switches, film.switches},
                                   {&false_frames, film.false_frames},
                                   {&false_tracks, film.false_tracks}})
    *own += other;
  first_pose.insert(first_pose.end(), film.first_pose.begin(), film.first_pose.end());
  seconds.insert(seconds.end(), film.seconds.begin(), film.seconds.end());
}

std::string sequenceText(const std::string& name, const SequenceScore& score) {
  char text[900];
  const double visible = std::max(1, score.visible);
  std::snprintf(text, sizeof(text),
                "%s: %d frames, %d poses asked for\n"
                "  within 1 cm and 2 degrees   %5.1f %%\n"
                "  within 3 cm and 20 degrees  %5.1f %%\n"
                "  jitter of standing objects  %.2f mm, %.2f degrees (%d poses)\n"
                "  first pose after            %.2f s (median), %.2f s (slowest); never: %d instances\n"
                "  switches of numbers         %d\n"
                "  false tracks                %d (%d answers)\n"
                "  time a frame                %.1f ms (median), %.1f ms (95 %%)\n",
                name.c_str(), score.frames, score.visible, 100.0 * score.tight / visible, 100.0 * score.loose / visible,
                1e3 * score.jitter_translation, score.jitter_rotation, score.standing, quantile(score.first_pose, 0.5),
                quantile(score.first_pose, 1.0), score.never_found, score.switches, score.false_tracks,
                score.false_frames, 1e3 * quantile(score.seconds, 0.5), 1e3 * quantile(score.seconds, 0.95));
  return text;
}

std::string sequenceJson(const SequenceScore& score) {
  const double visible = std::max(1, score.visible);
  const nlohmann::ordered_json json = {{"frames", score.frames},
                                       {"poses", score.visible},
                                       {"within_1cm_2deg", score.tight / visible},
                                       {"within_3cm_20deg", score.loose / visible},
                                       {"jitter_mm", 1e3 * score.jitter_translation},
                                       {"jitter_deg", score.jitter_rotation},
                                       {"standing_poses", score.standing},
                                       {"first_pose_s_median", quantile(score.first_pose, 0.5)},
                                       {"first_pose_s_max", quantile(score.first_pose, 1.0)},
                                       {"never_found", score.never_found},
                                       {"identity_switches", score.switches},
                                       {"false_tracks", score.false_tracks},
                                       {"false_answers", score.false_frames},
                                       {"frame_ms_p50", 1e3 * quantile(score.seconds, 0.5)},
                                       {"frame_ms_p95", 1e3 * quantile(score.seconds, 0.95)}};
  return json.dump(1) + "\n";
}

}  // namespace recognition
