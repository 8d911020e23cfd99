#include "alignment/control_poses.h"

#include <gtest/gtest.h>

#include "alignment/synthetic_scene.h"

namespace recognition {
namespace {

using synthetic::poseAt;

/// A box with patches of colours.
class Peak : public ::testing::Test {
 protected:
  Peak() {
    models_ = {synthetic::makeModel(box_, "box")};
    scene_ = synthetic::render({{box_, at_}}, models_, {});
    model_ = prepareModel(models_[0]);
  }

  /// What is bright right of the middle of the box becomes as bright as the camera can tell.
  void overexposeRightHalf() {
    SceneView& view = scene_->view;
    const int middle = cvRound(view.camera.project(at_.translation()).x());
    const cv::Rect right(middle, 0, view.lab.cols - middle, view.lab.rows);
    view.lab(right).setTo(cv::Scalar(100.0, 0.0, 0.0), isBright(view.lab(right)));
    view.clipped(right).setTo(255, isBright(view.lab(right)));
  }

  static cv::Mat isBright(const cv::Mat& lab) {
    cv::Mat lightness;
    cv::extractChannel(lab, lightness, 0);
    return lightness > 60.0f;
  }

  double peak(const Pose& pose, bool drops_clipped) const {
    ProbeLimits limits;
    limits.drops_clipped = drops_clipped;
    return colorPeak(model_, 800, pose, scene_->view, limits);
  }

  synthetic::Solid box_ = synthetic::box(1);
  Pose at_ = poseAt({0.0, 0.0, 0.8});
  std::vector<ObjectModel> models_;
  PreparedModel model_;
  std::unique_ptr<synthetic::Scene> scene_;
};

TEST_F(Peak, IsHighAtThePoseAndNotBesideIt) {
  EXPECT_GT(peak(at_, false), 0.3);
  EXPECT_GT(peak(at_, true), 0.3);
  EXPECT_LT(peak(Eigen::Translation3d(0.02, 0.0, 0.0) * at_, true), 0.0);
}

TEST_F(Peak, StandsWhereTheCameraClips) {
  overexposeRightHalf();
  EXPECT_GT(peak(at_, true), 0.2);
  EXPECT_LT(peak(at_, false), peak(at_, true));
  EXPECT_LT(peak(Eigen::Translation3d(0.02, 0.0, 0.0) * at_, true), 0.0);
}

}  // namespace
}  // namespace recognition
