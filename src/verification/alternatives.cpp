#include "alternatives.h"

#include <algorithm>
#include <cmath>

namespace rgbd_recognition {
namespace {

constexpr size_t kSamples = 400;
constexpr int kMinSamples = 30;
constexpr float kMinFacing = 0.2f;   // cosine
constexpr float kDepthGate = 0.03f;  // metres
constexpr double kMargin = 0.15;     // a coarse correlation that is lower by more than this is not tried
constexpr size_t kMaxTried = 2;

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
  int count() const { return n_; }
  double value() const {
    const double mm = mm_ - m_.dot(m_) / n_, ss = ss_ - s_.dot(s_) / n_, ms = ms_ - m_.dot(s_) / n_;
    return mm > 0.0 && ss > 0.0 ? ms / std::sqrt(mm * ss) : 0.0;
  }

 private:
  cv::Vec3d m_{0, 0, 0}, s_{0, 0, 0};
  double mm_ = 0.0, ss_ = 0.0, ms_ = 0.0;
  int n_ = 0;
};

struct Rated {
  const LookAlike* look_alike;
  double correlation;
};

}  // namespace

double printCorrelation(const PreparedModel& model, const Pose& camera_from_object, const SceneView& scene) {
  const Eigen::Matrix3f rotation = camera_from_object.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_object.translation().cast<float>();
  const size_t step = std::max<size_t>(1, model.positions.size() / (2 * kSamples));  // about half face the camera
  Correlation correlation;
  for (size_t i = 0; i < model.positions.size(); i += step) {
    const Eigen::Vector3f p = rotation * model.positions[i] + translation;
    if (p.z() <= 0.0f || -(rotation * model.normals[i]).dot(p) < kMinFacing * p.norm()) continue;
    const Eigen::Vector2d pixel = scene.camera.project(p.cast<double>());
    const cv::Point m(cvRound(pixel.x()), cvRound(pixel.y()));
    if (m.x < 0 || m.y < 0 || m.x >= scene.depth.cols || m.y >= scene.depth.rows) continue;
    const float z = scene.depth.at<float>(m);
    if (z > 0.0f && std::abs(z - p.z()) > kDepthGate) continue;
    correlation.add(model.lab[i], scene.lab.at<cv::Vec3f>(m));
  }
  return correlation.count() >= kMinSamples ? correlation.value() : 0.0;
}

std::vector<TestedHypothesis> testAlternatives(const TestedHypothesis& tested, const PreparedModels& models,
                                               const SceneView& scene, const Segmentation& segmentation,
                                               const VerificationParameters& parameters) {
  const int object = tested.verified.hypothesis.object;
  const Pose& pose = tested.verified.camera_from_object;
  const double least = printCorrelation(models.at(object), pose, scene) - kMargin;
  std::vector<Rated> rated;
  for (const LookAlike& other : models.lookAlikes(object)) {
    const double correlation = printCorrelation(models.at(other.object), pose * other.object_from_other, scene);
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
    hypothesis.round = tested.verified.hypothesis.round;
    alternatives.push_back(testHypothesis(hypothesis, models.object(hypothesis.object), models.at(hypothesis.object),
                                          scene, segmentation, parameters, parameters.theta_c,
                                          tested.verified.evidence.inliers));
  }
  return alternatives;
}

}  // namespace rgbd_recognition
