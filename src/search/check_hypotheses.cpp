#include "search/check_hypotheses.h"

#include <stdexcept>
#include <string>

namespace recognition {
namespace {

constexpr double kMaxSkew = 1e-3;  // of a rotation matrix times its transpose

void checkIndices(int object, const std::vector<Correspondence>& pairs, const PreparedModels& models,
                  const SceneView& scene) {
  if (object < 0 || object >= models.count())
    throw std::invalid_argument("hypothesis of object " + std::to_string(object) + " of " +
                                std::to_string(models.count()));
  const auto own = models.object(object).features.find(scene.features->image.type);
  const int model_features =
      own == models.object(object).features.end() ? 0 : static_cast<int>(own->second.positions.size());
  const int scene_features = static_cast<int>(scene.features->points.size());
  for (const Correspondence& c : pairs)
    if (c.scene_feature < 0 || c.scene_feature >= scene_features || c.model_feature < 0 ||
        c.model_feature >= model_features)
      throw std::invalid_argument("correspondence of scene feature " + std::to_string(c.scene_feature) + " of " +
                                  std::to_string(scene_features) + " with model feature " +
                                  std::to_string(c.model_feature) + " of " + std::to_string(model_features));
}

void checkPose(const Hypothesis& hypothesis, const PreparedModels& models) {
  const Pose& pose = hypothesis.camera_from_object;
  const Eigen::Matrix3d squared = pose.linear() * pose.linear().transpose();
  if (pose.matrix().allFinite() && (squared - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxSkew &&
      pose.linear().determinant() > 0.0)
    return;
  throw std::invalid_argument("hypothesis of object " + models.object(hypothesis.object).name +
                              " has a pose that is no rigid motion");
}

}  // namespace

void checkHypotheses(const std::vector<Hypothesis>& hypotheses, const PreparedModels& models, const SceneView& scene) {
  for (const Hypothesis& hypothesis : hypotheses) {
    checkIndices(hypothesis.object, hypothesis.consensus, models, scene);
    checkPose(hypothesis, models);
  }
}

void checkMatches(const SceneMatches& matches, const PreparedModels& models, const SceneView& scene) {
  if (matches.by_object.size() != static_cast<size_t>(models.count()))
    throw std::invalid_argument("matches of " + std::to_string(matches.by_object.size()) + " objects, not " +
                                std::to_string(models.count()));
  for (int object = 0; object < models.count(); ++object)
    checkIndices(object, matches.by_object[static_cast<size_t>(object)], models, scene);
}

}  // namespace recognition
