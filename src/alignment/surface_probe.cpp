#include "alignment/surface_probe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include <opencv2/core/utility.hpp>

#include "alignment/probe_kernels.h"

namespace recognition {
namespace {

constexpr float kAgreement = 0.025f;  // metres
constexpr int kFirstBlock = 40;       // points; about half of them face the camera
constexpr int kFirstLook = 16;        // points that face the camera: enough to stop
constexpr int kMinCompared = 8;       // colours
// CIELAB L of the model from which a clipped pixel says nothing: it could be any brightness. Chosen by eye.
constexpr float kMaybeClipped = 60.0f;

constexpr std::array<float, 4> kGates = {0.05f, 0.04f, 0.03f, 0.02f};  // metres, of the iterations of settling
constexpr int kMinAligned = 8;                                         // points
// Damping of a step, beside the sums over the points.
constexpr float kTranslationDamping = 0.1f, kRotationDamping = 0.001f;

/// Sums of a correlation over three channels.
class Correlation {
 public:
  void add(const cv::Vec3f& m, const cv::Vec3f& s) {
    for (int c = 0; c < 3; ++c) {
      m_[c] += m[c];
      s_[c] += s[c];
      mm_ += m[c] * m[c];
      ss_ += s[c] * s[c];
      ms_ += m[c] * s[c];
    }
    ++n_;
  }
  double value() const {
    if (n_ < kMinCompared) return 0.0;
    const double mm = mm_ - m_.dot(m_) / n_, ss = ss_ - s_.dot(s_) / n_, ms = ms_ - m_.dot(s_) / n_;
    return mm > 0.0 && ss > 0.0 ? ms / std::sqrt(mm * ss) : 0.0;
  }

 private:
  cv::Vec3d m_{0, 0, 0}, s_{0, 0, 0};
  double mm_ = 0.0, ss_ = 0.0, ms_ = 0.0;
  int n_ = 0;
};

/// A point, and the pixel whose colour is compared with its own.
struct SeenColor {
  int point, column, row;
};

double correlationOf(const SeenColor* seen, int count, const ProbePoints& points, const SceneView& scene,
                     bool drops_clipped) {
  const auto model_color = [&](const SeenColor* one) { return points.lab[static_cast<size_t>(one->point)]; };
  Correlation correlation;
  for (const SeenColor* one = seen; one < seen + count; ++one)
    if (!drops_clipped || model_color(one)[0] < kMaybeClipped || !scene.clipped.at<std::uint8_t>(one->row, one->column))
      correlation.add(model_color(one), scene.lab.at<cv::Vec3f>(one->row, one->column));
  return correlation.value();
}

}  // namespace

ProbeResult probeSurface(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene,
                         const ProbeLimits& limits) {
  const ProbeView view(scene, camera_from_object.cast<float>());
  const ProbePoints& own = model.probe_points;
  const int count = std::min(own.count(), points);
  ProbeResult result;
  ProbeLooks looks;
  cv::AutoBuffer<SeenColor> seen(static_cast<size_t>(count));  // on the stack, unless there are very many
  int colors = 0, agreeing = 0, free_space = 0, outside = 0, block = kFirstBlock;
  for (int first = 0; first < count; first += block, block = kProbeBlock) {
    block = std::min(block, count - first);
    lookAt(view, own, first, block, &looks);
    for (int i = 0; i < block; ++i) {
      const float z = looks.depth[i], expected = looks.position[2][i];
      if (z == kTurnedAway) continue;
      ++result.facing;
      if (z == kOutsideView) {
        ++outside;
        continue;
      }
      const bool behind = z > expected + kAgreement, unknown = z <= 0.0f;
      free_space += behind ? 1 : 0;
      if (behind || (!unknown && z < expected - kAgreement)) continue;
      agreeing += unknown ? 0 : 1;
      seen[static_cast<size_t>(colors++)] = {first + i, static_cast<int>(looks.column[i]),
                                             static_cast<int>(looks.row[i])};
    }
    if (result.facing > kFirstLook && 2 * free_space > result.facing) break;
  }
  if (result.facing == 0) return result;
  result.agreeing = static_cast<double>(agreeing) / result.facing;
  result.free_space = static_cast<double>(free_space) / result.facing;
  result.outside = static_cast<double>(outside) / result.facing;
  if (limits.hold(result)) result.correlation = correlationOf(seen.data(), colors, own, scene, limits.drops_clipped);
  return result;
}

Pose alignToDepth(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene) {
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;
  const int count = std::min({model.probe_points.count(), points, kProbeBlock});
  Eigen::Isometry3f pose = camera_from_object.cast<float>();
  ProbeLooks looks;
  for (const float gate : kGates) {
    const Eigen::Vector3f anchor = pose * model.centre;
    const ProbeView view(scene, pose);
    lookAt(view, model.probe_points, 0, count, &looks);
    const PlaneSums sums = sumPlanes(view, looks, count, anchor.data(), gate);
    if (sums.used < kMinAligned) return camera_from_object;
    Matrix6f hessian;
    for (int a = 0, k = 0; a < 6; ++a)
      for (int b = 0; b <= a; ++b, ++k) hessian(a, b) = hessian(b, a) = sums.equations.hessian[k];
    hessian.diagonal().head<3>().array() += kTranslationDamping;
    hessian.diagonal().tail<3>().array() += kRotationDamping;
    const Vector6f step = hessian.ldlt().solve(Eigen::Map<const Vector6f>(sums.equations.gradient));
    if (!step.allFinite()) return camera_from_object;
    const Eigen::Vector3d turn = step.tail<3>().cast<double>();
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
    const Eigen::Quaterniond rotation(pose.linear().cast<double>());
    pose.linear() = (turned * rotation).normalized().toRotationMatrix().cast<float>();
    pose.translation() = anchor + step.head<3>() - pose.linear() * model.centre;
  }
  return pose.cast<double>();
}

}  // namespace recognition
