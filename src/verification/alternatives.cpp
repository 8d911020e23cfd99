#include "verification/alternatives.h"

#include <algorithm>

#include "alignment/surface_probe.h"

namespace recognition {
namespace {

constexpr int kProbe = 800;       // points
constexpr double kMargin = 0.15;     // a coarse correlation that is lower by more than this is not tried
constexpr size_t kMaxTried = 2;

struct Rated {
  const SymmetricAlternative* look_alike;
  double correlation;
};

}  // namespace

std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const Segmentation& segmentation,
                                               const VerificationParameters& parameters) {
  const int object = tested.verified.hypothesis.object;
  const Pose& pose = tested.verified.camera_from_object;
  const double least = probeSurface(models.at(object), kProbe, pose, scene).correlation - kMargin;
  std::vector<Rated> rated;
  for (const SymmetricAlternative& other : models.alternatives(object)) {
    const double correlation =
        probeSurface(models.at(other.object), kProbe, pose * other.object_from_other, scene).correlation;
    if (correlation >= least) rated.push_back({&other, correlation});
  }
  std::stable_sort(rated.begin(), rated.end(),
                   [](const Rated& a, const Rated& b) { return a.correlation > b.correlation; });
  if (rated.size() > kMaxTried) rated.resize(kMaxTried);
  std::vector<TestedHypothesis> alternatives;
  for (const Rated& r : rated) {
    Hypothesis hypothesis;
    hypothesis.object = r.look_alike->object;
    hypothesis.camera_from_object = pose * r.look_alike->object_from_other;
    hypothesis.source = HypothesisSource::kAlternative;
    hypothesis.round = tested.verified.hypothesis.round;
    alternatives.push_back(testHypothesis(hypothesis, models.object(hypothesis.object), models.at(hypothesis.object),
                                          scene, segmentation, parameters, parameters.theta_c,
                                          tested.verified.evidence.inliers));
  }
  return alternatives;
}

}  // namespace recognition
