#include "verification/selection.h"
#include "alignment/prepared_model.h"
#include "verification/confidence.h"
#include "verification/pixel_consistency.h"
#include "verification/rivals.h"

#include <algorithm>
#include <map>

namespace recognition {
namespace {

constexpr double kSamePixels = 0.6;     // of the pixels of either of two rivals
constexpr double kRivalStrength = 0.3;  // of the stronger one's
// Standard errors. Of 16 pairs of twins in hard 2001, wide 1002 and wide 1003 (on which it was chosen) the right one is
// preferred in 14; the two others are below 0.8, and stay as they are.
constexpr double kClearPreference = 1.0;

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

double strength(const TestedHypothesis& h) { return explanatoryStrength(h.verified.evidence, h.verified.confidence); }

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

/// Whether most of the pixels that either explains are explained by both.
bool explainTheSame(const TestedHypothesis& a, const TestedHypothesis& b) {
  const cv::Rect common = a.reprojected.box & b.reprojected.box;
  if (common.area() < kSamePixels * std::max(a.reprojected.box.area(), b.reprojected.box.area())) return false;
  int of_a = 0, of_b = 0, of_both = 0;
  forExplained(a, [&](int v, int u) {
    ++of_a;
    of_both += common.contains({u, v}) &&
               b.pixels.state.at<PixelState>(cv::Point(u, v) - b.reprojected.box.tl()) == PixelState::kConsistent;
  });
  forExplained(b, [&](int, int) { ++of_b; });
  return of_both > kSamePixels * std::max(of_a, of_b);
}

/// What two objects have in common decides most of their strength, so a detail in which they differ hardly moves it.
void putRivalsInOrder(const PreparedModels& models, const SceneView& scene, std::vector<TestedHypothesis*>* order) {
  for (size_t j = 1; j < order->size(); ++j)
    for (size_t i = 0; i < j; ++i) {
      const TestedHypothesis& first = *(*order)[i];
      const TestedHypothesis& second = *(*order)[j];
      if (first.verified.hypothesis.object == second.verified.hypothesis.object) continue;
      if (strength(second) < kRivalStrength * strength(first) || !explainTheSame(first, second)) continue;
      if (colorPreference(second, first, models, scene) <= kClearPreference) continue;
      std::rotate(order->begin() + static_cast<std::ptrdiff_t>(i), order->begin() + static_cast<std::ptrdiff_t>(j),
                  order->begin() + static_cast<std::ptrdiff_t>(j) + 1);
      break;
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

void selectByPixels(const PreparedModels& models, const std::vector<TestedHypothesis*>& hypotheses,
                    const SceneView& scene, double max_overlap) {
  std::vector<TestedHypothesis*> order = accepted(hypotheses);
  std::stable_sort(order.begin(), order.end(),
                   [](const TestedHypothesis* a, const TestedHypothesis* b) { return strength(*a) > strength(*b); });
  putRivalsInOrder(models, scene, &order);
  cv::Mat owner(scene.depth.size(), CV_32SC1, cv::Scalar(-1));  // index in `order`
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
