#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meshes/surface_sampling.h"
#include "simulation/shapes.h"
#include "training/turntable.h"
#include "rgbd_recognition/core/frame.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

using testing::HasSubstr;

// A ball rests on a point: views see under it, and the estimate of what none sees must not fill that.
TEST(RecordedObject, SigmaOfABall) {
  const TexturedMesh ball = makeSphere(0.06, blobTexture(512, 5), 40);
  const Turntable turntable(charuco(), ball, Pose(Eigen::Translation3d(0.0, 0.0, 0.06)));
  RecordedObject object({}, FeatureParameters(), charuco());
  for (const double elevation : {25.0, 50.0})
    for (const RgbdFrame& frame : recordTurn(turntable, 18, elevation)) object.add({frame, std::nullopt, {}});
  const Extents is = object.build("ball", {}).model.extents, should = computeExtents(sampleSurface(ball, 0.003, 30000));
  EXPECT_NEAR(is.sigma_min, should.sigma_min, 0.03 * should.sigma_min);
  EXPECT_NEAR(is.sigma_max, should.sigma_max, 0.03 * should.sigma_max);
  EXPECT_NEAR(is.sigma_d, should.sigma_d, 0.03 * should.sigma_d);
}

// Raises what is measured of the board, as noise does here and there.
void raiseBoard(RgbdFrame& frame, const Pose& camera_from_board, double height) {
  const Pose board_from_camera = camera_from_board.inverse();
  const double eye = board_from_camera.translation().z();
  for (int v = 0; v < frame.depth.rows; ++v)
    for (int u = 0; u < frame.depth.cols; ++u) {
      auto& z = frame.depth.at<float>(v, u);
      const double above = (board_from_camera * frame.color_camera.unproject(u, v, z)).z();
      if (z > 0.0f && above < 0.004) z *= static_cast<float>((eye - height) / (eye - above));
    }
}

// What a few views measure too high beside the ball is the board's for all the others.
TEST(RecordedObject, TheBoardIsNoPartOfTheObject) {
  const Turntable turntable(charuco(), makeSphere(0.06, blobTexture(512, 5), 40),
                            Pose(Eigen::Translation3d(0.0, 0.0, 0.06)));
  RecordedObject object({}, FeatureParameters(), charuco());
  for (int i = 0; i < 30; ++i) {
    const Pose pose = orbitPose(12.0 * i, 35.0, 0.7, {0, 0, 0.05});
    RgbdFrame frame = turntable.view(pose, static_cast<std::uint64_t>(i));
    if (i % 10 == 0) raiseBoard(frame, pose, 0.008);
    ASSERT_EQ(object.add({frame, std::nullopt, {}}), "");
  }
  for (const SurfacePoint& point : object.build("ball", {}).model.cloud)
    EXPECT_NEAR((point.position - Eigen::Vector3f(0.0f, 0.0f, 0.06f)).norm(), 0.06f, 0.006f)
        << point.position.transpose() << " normal " << point.normal.transpose();
}

// A box of a tube's size: most of what is measured of it lies beside depth's edges.
class ThinObject : public testing::Test {
 protected:
  // Whether it is pushed aside, metres, after half of the views.
  static std::string reasonAgainstPushed(double shift) {
    const TexturedMesh tube = boxMesh({0.16f, 0.03f, 0.012f}, blobTexture(512, 5));
    const Pose place =
        Pose(Eigen::Translation3d(0.02, -0.01, 0.006)) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
    const Turntable at_first(charuco(), tube, place),
        later(charuco(), tube, Pose(Eigen::Translation3d(0.0, shift, 0.0)) * place);
    RecordedObject object({}, FeatureParameters(), charuco());
    for (int i = 0; i < 24; ++i) {
      const Turntable& turntable = i < 12 ? at_first : later;
      RgbdFrame frame = turntable.view(orbitPose(15.0 * i, 35.0, 0.7, {0, 0, 0.05}), static_cast<std::uint64_t>(i));
      spreadEdges(frame.depth);
      object.add({frame, std::nullopt, {}});
    }
    return reasonAgainst(object);
  }

  // As a correlation window does: what is near spreads over what is behind.
  static void spreadEdges(cv::Mat& depth) {
    cv::Mat spread;
    cv::erode(depth, spread, cv::Mat(), cv::Point(-1, -1), 2);
    spread.copyTo(depth, spread < depth - 0.006f);
  }
};

TEST_F(ThinObject, IsTrained) { EXPECT_THAT(reasonAgainstPushed(0.0), HasSubstr("built")); }
TEST_F(ThinObject, IsRefusedIfItMoves) { EXPECT_THAT(reasonAgainstPushed(0.025), HasSubstr("move")); }

// What was measured of one surface scatters along its normal: a sheet is left of it, in its middle.
TEST(ThinMeasuredSurface, LeavesOneSheetOfALayer) {
  cv::RNG rng(3);
  std::vector<SurfacePoint> layer;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3f p(rng.uniform(0.0f, 0.06f), rng.uniform(0.0f, 0.06f),
                            static_cast<float>(rng.gaussian(0.0012)));
    layer.push_back({p, Eigen::Vector3f::UnitZ(), {}});
    // A thin wall's other side.
    layer.push_back({p - 0.004f * Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ(), {}});
  }
  const std::vector<float> weights(layer.size(), 1.0f);
  int upper = 0, lower = 0;
  for (const SurfacePoint& point : thinMeasuredSurface(layer, weights, 0.002f, 0.006f)) {
    const bool is_upper = point.normal.z() > 0.0f;
    ++(is_upper ? upper : lower);
    EXPECT_NEAR(point.position.z(), is_upper ? 0.0f : -0.004f, 0.001f);
  }
  // Points at least 2 mm apart: at most one for each 3.46 mm^2 of the 3600 mm^2, about 0.5 for each 4 mm^2.
  for (const int count : {upper, lower}) {
    EXPECT_GT(count, 350);
    EXPECT_LT(count, 650);
  }
}

}  // namespace
}  // namespace recognition
