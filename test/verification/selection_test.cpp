#include "verification/selection.h"

#include <gtest/gtest.h>

#include "alignment/synthetic_scene.h"
#include "verification/rivals.h"

namespace recognition {
namespace {

/// A box, its twin whose front differs in a detail, and a frame that shows one of the two.
class Twins : public ::testing::TestWithParam<int> {
 protected:
  Twins() {
    synthetic::Solid box = synthetic::box(1), twin = box;
    const auto base = box.texture, other = synthetic::patchwork(77);
    twin.texture = [=](const Eigen::Vector3d& p) {
      return p.z() < -0.02 && std::abs(p.x() - 0.02) < 0.012 && std::abs(p.y() - 0.02) < 0.012 ? other(p) : base(p);
    };
    objects_ = {synthetic::makeModel(box, "box"), synthetic::makeModel(twin, "twin")};
    database_ = synthetic::databaseOf(objects_);
    scene_ = synthetic::render({{GetParam() == 0 ? box : twin, synthetic::poseAt({0.0, 0.0, 0.8})}}, objects_, {});
    models_ = std::make_unique<PreparedModels>(database_);
  }

  /// The box or its twin where the frame shows one of them.
  TestedHypothesis tested(int object) const {
    Hypothesis hypothesis = scene_->truth[0];
    hypothesis.object = object;
    const auto rule = makeAcceptanceRule(parameters_, 0);
    return PoseVerification(parameters_, {}, *models_, scene_->view, *scene_->view.segmentation, *rule)
        .test(hypothesis);
  }

  VerificationParameters parameters_;
  std::vector<ObjectModel> objects_;
  ModelDatabase database_;
  std::unique_ptr<synthetic::Scene> scene_;
  std::unique_ptr<PreparedModels> models_;
};

TEST_P(Twins, ADetailDecidesAgainstMoreFeatures) {
  TestedHypothesis right = tested(GetParam()), wrong = tested(1 - GetParam());
  ASSERT_TRUE(right.verified.accepted() && wrong.verified.accepted());
  right.verified.confidence = 0.99;  // as if chance had given the wrong one more of the features that both have
  wrong.verified.confidence = 0.9999;
  selectByPixels(*models_, {&wrong, &right}, scene_->view, parameters_.max_overlap);
  EXPECT_TRUE(right.verified.accepted());
  EXPECT_EQ(wrong.verified.rejection, Rejection::kConflict);
  EXPECT_EQ(wrong.verified.conflict_with, objects_[static_cast<size_t>(GetParam())].name);
}

TEST_P(Twins, ColorsPreferTheOneThatIsThere) {
  const TestedHypothesis right = tested(GetParam()), wrong = tested(1 - GetParam());
  EXPECT_GT(colorPreference(right, wrong, *models_, scene_->view), 2.0);
  EXPECT_LT(colorPreference(wrong, right, *models_, scene_->view), -2.0);
  EXPECT_EQ(colorPreference(right, right, *models_, scene_->view), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Either, Twins, ::testing::Values(0, 1));

}  // namespace
}  // namespace recognition
