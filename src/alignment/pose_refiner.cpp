#include "alignment/pose_refiner.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "alignment/alignment_kernels.h"
#include "alignment/normal_equations.h"
#include "core/angles.h"
#include "core/depth_noise.h"
#include "alignment/depth_buffer.h"

namespace recognition {
namespace {

constexpr int kMinSamples = 12;
constexpr double kCandidates = 4.5;       // points of the cloud a sample, of which those that are seen are taken
constexpr double kFirstDepthGate = 0.03;  // metres; shrinks each iteration down to the last
constexpr double kLastDepthGate = 0.008;
constexpr double kDepthFloor = 0.0015;  // metres: calibration and mesh errors beside the sensor's noise
constexpr double kDepthIndependent =
    40.0;  // the sensor's error is smooth: a patch's samples are worth no more than so many
constexpr double kFeaturePixels = 1.2;     // depth pixels, standard deviation of a keypoint
constexpr double kFeatureRange = 0.006;    // metres, of a keypoint's depth, beside the sensor's noise
constexpr double kFirstFeatureGate = 6.0;  // standard deviations
constexpr double kLastFeatureGate = 3.0;
constexpr double kLightnessSigma = 12.0;  // CIELAB L: noise, texture of the mesh, highlights
constexpr double kLightnessIndependent = 100.0;
constexpr double kLightnessGate = 2.0;      // standard deviations
constexpr int kSampleAgain = 4;             // iteration with a second depth buffer
constexpr double kCooling = 0.6;            // of the gates, each iteration
constexpr double kSmallTranslation = 1e-4;  // metres
constexpr double kSmallRotation = 1e-3;     // radians
// Priors of a step, which hold what nothing else does; the magnification's says how far focal length, the scale of
// depth and that of the mesh may disagree (1 to 5 % on real sensors), so that the image does not push the object away.
constexpr double kPriorMagnification = 0.02;
// Covariance: what the residuals do not show. But for the first, chosen on simulated frames, `wg` 1001 and 1002 (wide)
// and 2001 (hard), so that 95 % of the normalised errors lie within the chi-square's 95 %.
constexpr double kCovarianceScale = 4.9;    // the residuals are not independent
constexpr double kDepthScaleSigma = 0.008;  // share of the distance: sensors measure too far or too near throughout
constexpr double kSystematicTranslation = 0.001;        // metres, of mesh and registration
constexpr double kSystematicRotation = 0.35 * kDegree;  // radians, likewise
// Deviations of what nothing determines: a turn by any angle, a shift by about an object's size.
constexpr double kAnyTranslation = 0.1;                 // metres
constexpr double kAnyRotation = 2.0 * kPi / 3.4641016;  // radians, of an angle evenly over the whole turn

/// Share of the variance of the frame's lightness that the model's explains, 0 to 1.
double explainedShare(const AlignedTexture& texture) {
  double m = 0.0, s = 0.0, mm = 0.0, ss = 0.0, ms = 0.0;
  for (size_t i = 0; i < texture.lightness.size(); ++i) {
    const double own = texture.lightness[i], seen = texture.seen[i];
    m += own;
    s += seen;
    mm += own * own;
    ss += seen * seen;
    ms += own * seen;
  }
  const double n = std::max<double>(1.0, texture.count());
  const double variances = (mm - m * m / n) * (ss - s * s / n), covariance = ms - m * s / n;
  return variances > 0.0 && covariance > 0.0 ? covariance * covariance / variances : 0.0;
}

/// One refinement: the pose, moved about the model's centre, and how much larger the image is than the pose has it.
class Refiner {
 public:
  Refiner(const PreparedModel& model, const ObjectModel& object, const Hypothesis& hypothesis, const SceneView& scene,
          const RefinementOptions& options, const Pose& camera_from_object)
      : model_(model),
        hypothesis_(hypothesis),
        scene_(scene),
        options_(options),
        centre_(model.centre.cast<double>()),
        pose_(camera_from_object) {
    const auto own = object.features.find(scene.features->image.type);
    if (options.use_features && own != object.features.end()) features_ = &own->second;
  }

  Refinement run() {
    Refinement refinement;
    refinement.camera_from_object = pose_;
    for (int i = 0; i < options_.iterations; ++i) {
      if (i == 0 || i == kSampleAgain) takeSamples();
      if (points_.count() < kMinSamples) return refinement;
      const NormalEquations equations = build(i);
      if (depth_weights_ < kMinSamples / 2.0) return refinement;
      const Vector7d step = solve(equations);
      if (!step.allFinite()) return refinement;
      apply(step);
      refinement.iterations = i + 1;
      const bool small = step.head<3>().norm() < kSmallTranslation && step.segment<3>(3).norm() < kSmallRotation;
      if (i > kSampleAgain && small) break;
    }
    refinement.camera_from_object = pose_;
    refinement.covariance =
        covariance(build(options_.iterations, true), prior(kAnyTranslation, kAnyRotation)) + systematicErrors();
    if (options_.wants_frame_noise)
      refinement.frame_noise = covariance(build(options_.iterations), prior(options_.max_step, options_.max_turn));
    refinement.success = true;
    return refinement;
  }

 private:
  /// Points that are seen at the present pose, evenly over the model's cloud.
  void takeSamples() {
    const size_t most = options_.samples;
    const auto candidates = static_cast<size_t>(kCandidates * static_cast<double>(most));
    std::vector<int> samples = visiblePoints(model_, pose_, scene_.camera, candidates);
    if (samples.size() > most) {
      for (size_t i = 0; i < most; ++i) samples[i] = samples[i * samples.size() / most];
      samples.resize(most);
    }
    points_.assign(model_, samples);
  }

  /// Information of a prior with these deviations.
  static Vector7d prior(double translation, double rotation) {
    Vector7d sigma;
    sigma << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation), kPriorMagnification;
    return sigma.array().square().inverse();
  }

  /// A step of the pose is drawn to none, the magnification itself to 0.
  Vector7d solve(const NormalEquations& equations) const {
    Matrix7d system = equations.hessian();
    const Vector7d step_prior = prior(options_.max_step, options_.max_turn);
    system.diagonal() += step_prior;
    Vector7d right = -equations.gradient();
    right[6] -= step_prior[6] * magnification_;
    return system.ldlt().solve(right);
  }

  /// `doubtful`: texture counts as far as the model explains it, for noise has gradients, too.
  NormalEquations build(int iteration, bool doubtful = false) {
    NormalEquations equations;
    points_.move(pose_, scene_);
    const double cooling = std::pow(kCooling, iteration);
    addDepth(std::max(kLastDepthGate, kFirstDepthGate * cooling), &equations);
    if (features_) addFeatures(std::max(kLastFeatureGate, kFirstFeatureGate * cooling), &equations);
    if (options_.use_lightness && iteration >= options_.lightness_from) addLightness(doubtful, &equations);
    return equations;
  }

  Eigen::Vector3d place(const Eigen::Vector3f& model_point) const { return pose_ * model_point.cast<double>(); }
  Eigen::Vector3d anchor() const { return pose_ * centre_; }

  void addDepth(double gate, NormalEquations* equations) {
    rows_.makeOfDepth(points_, anchor(), gate, kDepthFloor);
    depth_weights_ = rows_.weights();
    equations->add(rows_, std::min(1.0, kDepthIndependent / points_.count()));
  }

  void addFeatures(double gate, NormalEquations* equations) const {
    const Eigen::Vector3d anchor_point = anchor();
    const Eigen::Vector2d middle = scene_.camera.project(anchor_point);
    const SceneFeatures& seen = *scene_.features;
    for (const Correspondence& c : hypothesis_.consensus) {
      const Eigen::Vector3d p = place(features_->positions.at(static_cast<size_t>(c.model_feature)));
      if (p.z() <= 0.0) continue;
      const Eigen::Vector2d keypoint =
          depthPixel(seen.image.keypoints.at(static_cast<size_t>(c.scene_feature)), scene_.color_per_depth);
      const Eigen::Vector2d spread = scene_.camera.project(p) - middle;
      const Eigen::Vector2d off = (middle + (1.0 + magnification_) * spread - keypoint) / kFeaturePixels;
      const double z = seen.points.at(static_cast<size_t>(c.scene_feature)).z();
      const double sigma_z = Eigen::Vector2d(depthSigma(z), kFeatureRange).norm();
      const double off_z = (p.z() - z) / sigma_z;
      const double weight = robustWeight((off.squaredNorm() + off_z * off_z) / (gate * gate));
      const double iz = 1.0 / p.z();
      const Eigen::Vector3d by_u(scene_.camera.fx * iz, 0.0, -scene_.camera.fx * p.x() * iz * iz);
      const Eigen::Vector3d by_v(0.0, scene_.camera.fy * iz, -scene_.camera.fy * p.y() * iz * iz);
      equations->add(off.x(), by_u / kFeaturePixels, spread.x() / kFeaturePixels, p - anchor_point, weight);
      equations->add(off.y(), by_v / kFeaturePixels, spread.y() / kFeaturePixels, p - anchor_point, weight);
      equations->add(off_z, Eigen::Vector3d(0.0, 0.0, 1.0 / sigma_z), 0.0, p - anchor_point, weight);
    }
  }

  void addLightness(bool doubtful, NormalEquations* equations) {
    texture_.collect(points_, scene_, anchor(), magnification_, kFirstDepthGate);
    const LightnessTransform illumination = fitLightness(texture_.lightness, texture_.seen);
    rows_.makeOfTexture(texture_, scene_.camera, anchor(), illumination, {kLightnessSigma, kLightnessGate});
    const double share = doubtful ? explainedShare(texture_) : 1.0;
    equations->add(rows_, share * std::min(1.0, kLightnessIndependent / (texture_.count() + 1)));
  }

  /// Moves the pose by a step about its anchor.
  void apply(const Vector7d& step) {
    const Eigen::Vector3d anchor_point = anchor(), turn = step.segment<3>(3);
    const double angle = turn.norm();
    if (angle > 0.0)
      pose_.linear() =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle) * pose_.linear()).normalized().toRotationMatrix();
    pose_.translation() = anchor_point + step.head<3>() - pose_.linear() * centre_;
    magnification_ += step[6];
  }

  /// Inverse Hessian of the last weights without the magnification, moved from the anchor to the object's origin.
  Matrix6d covariance(const NormalEquations& equations, const Vector7d& bound) const {
    Matrix7d information = equations.hessian() / (kCovarianceScale * std::max(1.0, equations.chiSquare()));
    information.diagonal() += bound;
    const Matrix6d at_anchor = information.ldlt().solve(Matrix7d::Identity()).topLeftCorner<6, 6>();
    Matrix6d origin_from_anchor = Matrix6d::Identity();
    origin_from_anchor.topRightCorner<3, 3>() = skew(pose_.linear() * centre_);
    const Matrix6d moved = origin_from_anchor * at_anchor * origin_from_anchor.transpose();
    return 0.5 * (moved + moved.transpose());
  }

  Matrix6d systematicErrors() const {
    const Eigen::Vector3d by_depth_scale = kDepthScaleSigma * pose_.translation();
    Matrix6d errors = Matrix6d::Zero();
    errors.topLeftCorner<3, 3>() = by_depth_scale * by_depth_scale.transpose();
    errors.diagonal().head<3>().array() += kSystematicTranslation * kSystematicTranslation;
    errors.diagonal().tail<3>().array() += kSystematicRotation * kSystematicRotation;
    return errors;
  }

  const PreparedModel& model_;
  const Hypothesis& hypothesis_;
  const SceneView& scene_;
  const RefinementOptions& options_;
  const ModelFeatures* features_ = nullptr;
  Eigen::Vector3d centre_;
  Pose pose_;
  double magnification_ = 0.0;
  AlignedPoints points_;
  AlignedTexture texture_;
  AlignmentRows rows_;
  double depth_weights_ = 0.0;
};

}  // namespace

Refinement refinePose(const PreparedModel& model, const ObjectModel& object, const Hypothesis& hypothesis,
                      const Pose& camera_from_object, const SceneView& scene, const RefinementOptions& options) {
  return Refiner(model, object, hypothesis, scene, options, camera_from_object).run();
}

}  // namespace recognition
