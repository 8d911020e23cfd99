#include "verification/selection.h"
#include "alignment/prepared_model.h"
#include "verification/pixel_consistency.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace recognition {
namespace {

std::vector<TestedHypothesis*> accepted(const std::vector<TestedHypothesis*>& hypotheses) {
  std::vector<TestedHypothesis*> out;
  for (TestedHypothesis* h : hypotheses)
    if (h->verified.accepted()) out.push_back(h);
  return out;
}

void rejectFor(const TestedHypothesis& winner, const PreparedModels& models, TestedHypothesis* loser) {
  const bool same = winner.verified.hypothesis.object == loser->verified.hypothesis.object;
  loser->verified.rejection = same ? Rejection::kDuplicate : Rejection::kConflict;
  loser->verified.conflict_with = models.object(winner.verified.hypothesis.object).name;
}

/// What a hypothesis explains, weighted by how little doubt is left: pixels alone would prefer a pose turned to where
/// the texture repeats but for a detail, as illumination and noise outweigh the detail.
double strength(const TestedHypothesis& h) {
  return h.verified.evidence.gain * -std::log(std::max(1e-9, 1.0 - h.verified.confidence));
}

/// Runs over the pixels of M_j whose depth agrees.
template <typename Visit>
void forExplained(const TestedHypothesis& hypothesis, Visit visit) {
  const cv::Rect& box = hypothesis.reprojected.box;
  for (int v = 0; v < box.height; ++v) {
    const auto* states = hypothesis.pixels.state.ptr<PixelState>(v);
    for (int u = 0; u < box.width; ++u)
      if (states[u] == PixelState::kConsistent) visit(v + box.y, u + box.x);
  }
}

}  // namespace

void selectBySegment(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses) {
  std::vector<TestedHypothesis*> order = accepted(hypotheses);
  std::stable_sort(order.begin(), order.end(), [](const TestedHypothesis* a, const TestedHypothesis* b) {
    return a->verified.scores.total > b->verified.scores.total;
  });
  std::map<int, const TestedHypothesis*> owner;  // of each segment
  for (TestedHypothesis* h : order) {
    const auto inserted = owner.emplace(h->verified.scores.best_segment, h);
    if (!inserted.second) rejectFor(*inserted.first->second, models, h);
  }
}

void selectByPixels(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses, cv::Size image_size,
                    double max_overlap) {
  std::vector<TestedHypothesis*> order = accepted(hypotheses);
  std::stable_sort(order.begin(), order.end(),
                   [](const TestedHypothesis* a, const TestedHypothesis* b) { return strength(*a) > strength(*b); });
  cv::Mat owner(image_size, CV_32SC1, cv::Scalar(-1));  // index in `order`
  for (size_t i = 0; i < order.size(); ++i) {
    std::vector<int> taken(i, 0);
    int own = 0, shared = 0;
    forExplained(*order[i], [&](int v, int u) {
      ++own;
      const int other = owner.at<int>(v, u);
      if (other < 0) return;
      ++shared;
      ++taken[static_cast<size_t>(other)];
    });
    if (shared > max_overlap * own) {
      const auto most = std::max_element(taken.begin(), taken.end());
      rejectFor(*order[static_cast<size_t>(most - taken.begin())], models, order[i]);
      continue;
    }
    forExplained(*order[i], [&](int v, int u) {
      int& pixel = owner.at<int>(v, u);
      if (pixel < 0) pixel = static_cast<int>(i);
    });
  }
}

}  // namespace recognition
