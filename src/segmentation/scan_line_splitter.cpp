#include "segmentation/scan_line_splitter.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "segmentation/residuals.h"

namespace recognition {
namespace {

constexpr int kTypeSupport = 8;  ///< samples a side from which the type of an edge point is told
constexpr int kShortestAiccSplit = 2 * kShortestAicc;

/// Least-squares line through z[first..last] (at least one sample).
Polynomial supportLine(const float* z, int first, int last) {
  const int n = last - first + 1;
  const double centre = 0.5 * (first + last);
  double sum = 0.0, tz = 0.0, tt = 0.0;
  for (int i = first; i <= last; ++i) {
    sum += z[i];
    tz += (i - centre) * z[i];
    tt += (i - centre) * (i - centre);
  }
  return {sum / n, tt > 0.0 ? tz / tt : 0.0, 0.0, centre};
}

}  // namespace

ScanLineSplitter::ScanLineSplitter(const SegmentationParameters& parameters)
    : mode_(parameters.mode),
      inverse_(parameters.noise_model == NoiseModel::kSensor),
      epsilon_(static_cast<float>(parameters.epsilon)),
      jump_(static_cast<float>(parameters.jump)),
      variance_(parameters.sigma * parameters.sigma),
      lateral_variance_(parameters.lateral * parameters.lateral),
      lambda_min_(parameters.lambda_min),
      switch_length_(parameters.lambda_min * parameters.f_mixed),
      tan_crease_(std::tan(parameters.crease_angle * kPi / 180.0)) {}

void ScanLineSplitter::split(const float* z, int n, double pitch) {
  z_ = z;
  pitch_ = pitch;
  tables_.reserve(n);
  if (residuals_.size() < static_cast<size_t>(n)) {
    residuals_.resize(static_cast<size_t>(n));
    scores_.resize(static_cast<size_t>(n));
  }
  segments_.clear();
  edges_.clear();
  int previous = -1;  // last valid sample before the run
  for (int first = 0; first < n;) {
    if (!(z[first] > 0.0f)) {
      ++first;
      continue;
    }
    if (previous >= 0 && std::abs(z[first] - z[previous]) > jump_ * static_cast<float>(first - previous))
      edges_.push_back({fartherOf(previous, first), EdgeType::kJump});
    int last = first;
    while (last + 1 < n && z[last + 1] > 0.0f && std::abs(z[last + 1] - z[last]) <= jump_) ++last;
    splitRun({first, last});
    previous = last;
    first = last + 1;
  }
}

void ScanLineSplitter::splitRun(SubSegment run) {
  run_begin_ = segments_.size();
  if (mode_ == SegmentationMode::kLsAicc)
    splitByAicc(run);
  else
    splitByResidual(run, mode_ == SegmentationMode::kLsMixed);
  for (size_t i = run_begin_ + 1; i < segments_.size(); ++i) {
    const EdgePoint edge = edgeBetween(segments_[i - 1], segments_[i]);
    if (edge.type != EdgeType::kNone) edges_.push_back(edge);
  }
}

void ScanLineSplitter::splitByResidual(SubSegment run, bool then_aicc) {
  if (mode_ == SegmentationMode::kLsLinear || mode_ == SegmentationMode::kLsQuadratic)
    sums_.build(z_, run.first, run.last);
  residual_stack_.assign(1, run);
  while (!residual_stack_.empty()) {
    const SubSegment s = residual_stack_.back();
    residual_stack_.pop_back();
    SubSegment left, right;
    if (then_aicc && s.size() < switch_length_) {
      splitByAicc(s);
    } else if (s.size() >= lambda_min_ && maximumResidualSplit(s, &left, &right)) {
      residual_stack_.push_back(right);
      residual_stack_.push_back(left);
    } else {
      segments_.push_back(s);
    }
  }
}

void ScanLineSplitter::splitByAicc(SubSegment run) {
  if (run.size() < kShortestAiccSplit) {
    segments_.push_back(run);
    return;
  }
  sums_.build(z_, run.first, run.last);
  aicc_stack_.assign(1, run);
  while (!aicc_stack_.empty()) {
    const SubSegment s = aicc_stack_.back();
    aicc_stack_.pop_back();
    SubSegment left, right;
    if (s.size() >= lambda_min_ && minimumAiccSplit(s, &left, &right)) {
      aicc_stack_.push_back(right);
      aicc_stack_.push_back(left);
    } else {
      segments_.push_back(s);
    }
  }
}

bool ScanLineSplitter::maximumResidualSplit(SubSegment s, SubSegment* left, SubSegment* right) {
  const LeastSquaresFit fit = mode_ == SegmentationMode::kLsLinear || mode_ == SegmentationMode::kLsQuadratic
                                  ? sums_.fit(s.first, s.last, tables_)
                                  : LeastSquaresFit();
  Polynomial p;
  if (mode_ == SegmentationMode::kSimpleLinear)
    p = fitSimpleLinear(z_, s.first, s.last);
  else if (mode_ == SegmentationMode::kLsLinear)
    p = sums_.linear(fit, s.first, s.last);
  else if (mode_ == SegmentationMode::kLsQuadratic)
    p = sums_.quadratic(fit, s.first, s.last, tables_);
  else
    p = fitSimpleQuadratic(z_, s.first, s.last);
  const std::int32_t largest = residualBits(z_ + s.first, s.size(), s.first, p, residuals_.data());
  const float epsilon = epsilonAt(p.c1);
  if (largest <= bitsOf(epsilon)) return false;
  const int k =
      s.first + static_cast<int>(std::find(residuals_.begin(), residuals_.end(), largest) - residuals_.begin());
  const float before = k > s.first ? std::abs(z_[k] - z_[k - 1]) : 0.0f;
  const float after = k < s.last ? std::abs(z_[k + 1] - z_[k]) : 0.0f;
  const bool shared = std::max(before, after) <= epsilon && k > s.first && k < s.last;
  const bool split_before = k == s.last || (k > s.first && before > after);
  *left = {s.first, shared || !split_before ? k : k - 1};
  *right = {shared || split_before ? k : k + 1, s.last};
  return true;
}

bool ScanLineSplitter::minimumAiccSplit(SubSegment s, SubSegment* left, SubSegment* right) {
  const int n = s.size();
  if (n < kShortestAiccSplit) return false;
  const LeastSquaresFit fit = sums_.fit(s.first, s.last, tables_);
  const double inverse_variance = 1.0 / varianceAt(fit.slope);
  const AdaptiveScore whole = adaptiveScore(fit, n, tables_, inverse_variance);
  const size_t half = static_cast<size_t>(n / 2);
  if (whole.aicc <= 2.0 * tables_.penalty_linear[half + 1]) return false;  // no split can score below
  const Polynomial p =
      whole.quadratic ? sums_.quadratic(fit, s.first, s.last, tables_) : sums_.linear(fit, s.first, s.last);
  residualBits(z_ + s.first, n, s.first, p, residuals_.data());
  sums_.splitScores(s.first, s.last, tables_, inverse_variance, scores_.data());
  const std::int32_t* r = residuals_.data();
  const auto peak = [r, n](int i) { return i > 0 && i < n - 1 && r[i] >= r[i - 1] && r[i] > r[i + 1]; };
  double best = whole.aicc;
  int best_left = 0;
  for (int left_size = kShortestAicc; left_size <= n - kShortestAicc; ++left_size) {
    if (scores_[static_cast<size_t>(left_size)] >= best || !(peak(left_size - 1) || peak(left_size))) continue;
    best = scores_[static_cast<size_t>(left_size)];
    best_left = left_size;
  }
  if (best_left == 0) return false;
  *left = {s.first, s.first + best_left - 1};
  *right = {s.first + best_left, s.last};
  return true;
}

float ScanLineSplitter::epsilonAt(double slope) const {
  return epsilon_ * static_cast<float>(std::sqrt(varianceAt(slope) / variance_));
}

int ScanLineSplitter::fartherOf(int i, int j) const { return (z_[i] > z_[j]) != inverse_ ? i : j; }

EdgePoint ScanLineSplitter::edgeBetween(SubSegment left, SubSegment right) const {
  const bool shared = left.last == right.first;
  const int left_last = shared && left.size() > 1 ? left.last - 1 : left.last;
  const int right_first = shared && right.size() > 1 ? right.first + 1 : right.first;
  const Polynomial before = supportLine(z_, std::max(left.first, left_last - kTypeSupport + 1), left_last);
  const Polynomial after = supportLine(z_, right_first, std::min(right.last, right_first + kTypeSupport - 1));
  const double boundary = 0.5 * (left.last + right.first);
  const double slope = std::max(std::abs(before.c1), std::abs(after.c1));
  if (std::abs(after.at(boundary) - before.at(boundary)) > epsilonAt(slope))
    return {shared ? left.last : fartherOf(left.last, right.first), EdgeType::kJump};
  if (!bends(0.5 * (z_[left.last] + z_[right.first]), before.c1, after.c1)) return {left.last, EdgeType::kNone};
  // A convex edge is nearer than its surroundings: depth bends upwards there, inverse depth downwards.
  const bool convex = (after.c1 > before.c1) != inverse_;
  return {left.last, convex ? EdgeType::kConvexCrease : EdgeType::kConcaveCrease};
}

/// Whether the surface turns by the crease angle between two slopes (change of z from sample to sample).
bool ScanLineSplitter::bends(double z, double slope_before, double slope_after) const {
  // Tangents of the surface's angles to the image plane: dz / (z pitch) for depth, and the same but for its sign for
  // inverse depth.
  const double before = slope_before / (z * pitch_), after = slope_after / (z * pitch_);
  const double cosine = 1.0 + before * after, sine = std::abs(after - before);
  return cosine <= 0.0 || sine >= tan_crease_ * cosine;
}

}  // namespace recognition
