#include "verification/alternatives.h"

#include <algorithm>

#include "alignment/surface_probe.h"

namespace recognition {
namespace {

constexpr int kProbe = 800;       // points
constexpr double kMargin = 0.15;  // a coarse correlation that is lower by more than this is not tried
constexpr size_t kMaxTried = 2;
constexpr double kCoarseMargin = 0.12;  // the same of the structure at half resolution

struct Rated {
  const SymmetricAlternative* alternative;
  double correlation;
};

}  // namespace

std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const PoseVerification& verification) {
  const int object = tested.verified.hypothesis.object;
  const Pose& pose = tested.verified.camera_from_object;
  const double min_correlation = probeSurface(models.at(object), kProbe, pose, scene).correlation - kMargin;
  std::vector<Rated> rated;
  for (const SymmetricAlternative& other : models.alternatives(object)) {
    const double correlation =
        probeSurface(models.at(other.object), kProbe, pose * other.object_from_other, scene).correlation;
    if (correlation >= min_correlation) rated.push_back({&other, correlation});
  }
  std::stable_sort(rated.begin(), rated.end(),
                   [](const Rated& a, const Rated& b) { return a.correlation > b.correlation; });
  if (rated.size() > kMaxTried) rated.resize(kMaxTried);
  std::vector<TestedHypothesis> alternatives;
  for (const Rated& r : rated) {
    Hypothesis hypothesis;
    hypothesis.object = r.alternative->object;
    hypothesis.camera_from_object = pose * r.alternative->object_from_other;
    hypothesis.source = HypothesisSource::kAlternative;
    hypothesis.round = tested.verified.hypothesis.round;
    TestedHypothesis other = verification.begin(hypothesis, tested.verified.evidence.inliers);
    verification.advanceTo(TestLevel::kCoarse, &other);
    if (other.coarse_structure < tested.coarse_structure - kCoarseMargin) continue;
    verification.advanceTo(TestLevel::kCompared, &other);
    alternatives.push_back(std::move(other));
  }
  return alternatives;
}

}  // namespace recognition
