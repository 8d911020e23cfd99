#include "rgbd_recognition/verification/surface_probe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace rgbd_recognition {
namespace {

constexpr float kLeastFacing = 0.2f;   // cosine
constexpr float kNearest = 0.1f;       // metres
constexpr float kAgreement = 0.025f;   // metres
constexpr int kFirstLook = 16;         // points that face the camera
constexpr int kLeastCompared = 8;      // colours

constexpr std::array<float, 4> kGates = {0.05f, 0.04f, 0.03f, 0.02f};  // metres, of the iterations of settling
constexpr int kLeastSettled = 8;                                        // points
// Damping of a step, beside the sums over the points.
constexpr float kPriorTranslation = 0.1f, kPriorRotation = 0.001f;

/// Where a frame's camera sees a point.
class Projection {
 public:
  explicit Projection(const SceneView& scene)
      : depth_(scene.depth),
        fx_(static_cast<float>(scene.camera.fx)),
        fy_(static_cast<float>(scene.camera.fy)),
        cx_(static_cast<float>(scene.camera.cx)),
        cy_(static_cast<float>(scene.camera.cy)) {}

  cv::Point pixel(const Eigen::Vector3f& p) const {
    return {cvRound(fx_ * p.x() / p.z() + cx_), cvRound(fy_ * p.y() / p.z() + cy_)};
  }
  bool inside(const cv::Point& m) const { return m.x >= 0 && m.y >= 0 && m.x < depth_.cols && m.y < depth_.rows; }
  float depth(const cv::Point& m) const { return depth_.at<float>(m); }
  Eigen::Vector3f place(const cv::Point& m, float z) const {
    return {(static_cast<float>(m.x) - cx_) / fx_ * z, (static_cast<float>(m.y) - cy_) / fy_ * z, z};
  }

 private:
  const cv::Mat& depth_;
  float fx_, fy_, cx_, cy_;
};

bool facesCamera(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) {
  const float facing = -normal.dot(p);
  return p.z() > kNearest && facing > 0.0f && facing * facing >= kLeastFacing * kLeastFacing * p.squaredNorm();
}

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
    if (n_ < kLeastCompared) return 0.0;
    const double mm = mm_ - m_.dot(m_) / n_, ss = ss_ - s_.dot(s_) / n_, ms = ms_ - m_.dot(s_) / n_;
    return mm > 0.0 && ss > 0.0 ? ms / std::sqrt(mm * ss) : 0.0;
  }

 private:
  cv::Vec3d m_{0, 0, 0}, s_{0, 0, 0};
  double mm_ = 0.0, ss_ = 0.0, ms_ = 0.0;
  int n_ = 0;
};

}  // namespace

ProbeResult probeSurface(const PreparedModel& model, int points, const Pose& camera_from_object,
                         const SceneView& scene) {
  const Eigen::Matrix3f rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  const Projection projection(scene);
  ProbeResult result;
  Correlation correlation;
  int agreeing = 0, free_space = 0;
  const size_t count = std::min(model.probe_points.size(), static_cast<size_t>(points));
  for (size_t i = 0; i < count; ++i) {
    const ProbePoint& point = model.probe_points[i];
    const Eigen::Vector3f p = rotation * point.position + translation;
    if (!facesCamera(p, rotation * point.normal)) continue;
    ++result.facing;
    if (result.facing > kFirstLook && 2 * free_space > result.facing) break;
    const cv::Point pixel = projection.pixel(p);
    if (!projection.inside(pixel)) continue;
    const float z = projection.depth(pixel);
    const bool behind = z > p.z() + kAgreement, unknown = z <= 0.0f;
    free_space += behind ? 1 : 0;
    if (behind || (!unknown && z < p.z() - kAgreement)) continue;
    agreeing += unknown ? 0 : 1;
    correlation.add(point.lab, scene.lab.at<cv::Vec3f>(pixel));
  }
  if (result.facing == 0) return result;
  result.agreeing = static_cast<double>(agreeing) / result.facing;
  result.free_space = static_cast<double>(free_space) / result.facing;
  result.correlation = correlation.value();
  return result;
}

Pose settleOnDepth(const PreparedModel& model, int points, const Pose& camera_from_object, const SceneView& scene) {
  using Vector6f = Eigen::Matrix<float, 6, 1>;
  using Matrix6f = Eigen::Matrix<float, 6, 6>;
  const Projection projection(scene);
  const size_t count = std::min(model.probe_points.size(), static_cast<size_t>(points));
  Eigen::Isometry3f pose = camera_from_object.cast<float>();
  for (const float gate : kGates) {
    const Eigen::Matrix3f rotation = pose.linear();
    const Eigen::Vector3f anchor = pose * model.centre;
    Matrix6f hessian = Matrix6f::Zero();
    Vector6f gradient = Vector6f::Zero();
    int used = 0;
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f p = pose * model.probe_points[i].position;
      const Eigen::Vector3f normal = rotation * model.probe_points[i].normal;
      if (!facesCamera(p, normal)) continue;
      const cv::Point pixel = projection.pixel(p);
      if (!projection.inside(pixel)) continue;
      const float z = projection.depth(pixel);
      if (z <= 0.0f || std::abs(z - p.z()) > 2.0f * gate) continue;
      const float distance = normal.dot(projection.place(pixel, z) - p), scaled = distance / gate;
      const float weight = 1.0f / ((1.0f + scaled * scaled) * (1.0f + scaled * scaled));
      Vector6f row;
      row.head<3>() = normal;
      row.tail<3>() = (p - anchor).cross(normal);
      hessian.noalias() += weight * row * row.transpose();
      gradient += weight * distance * row;
      ++used;
    }
    if (used < kLeastSettled) return camera_from_object;
    hessian.diagonal().head<3>().array() += kPriorTranslation;
    hessian.diagonal().tail<3>().array() += kPriorRotation;
    const Vector6f step = hessian.ldlt().solve(gradient);
    if (!step.allFinite()) return camera_from_object;
    const Eigen::Vector3d turn = step.tail<3>().cast<double>();
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
    const Eigen::Quaterniond settled = (turned * Eigen::Quaterniond(rotation.cast<double>())).normalized();
    pose.linear() = settled.toRotationMatrix().cast<float>();
    pose.translation() = anchor + step.head<3>() - pose.linear() * model.centre;
  }
  return pose.cast<double>();
}

}  // namespace rgbd_recognition
