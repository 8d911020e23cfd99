#include "tracking/track_verification.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "alignment/control_poses.h"
#include "alignment/surface_probe.h"
#include "verification/evidence.h"
#include "verification/pixel_consistency.h"

namespace recognition {
namespace {

constexpr int kMargin = 16;        // pixels round the model that the alignment may need
constexpr int kSearchMargin = 60;  // likewise, for the search around
constexpr int kProbePoints = 120;
constexpr int kPeakPoints = 800;
constexpr double kSearchStep = 0.04;  // metres
constexpr int kIterations = 7;
constexpr size_t kSamples = 300;
// Of the alignment; chosen by hand on the film of seed 11 of doc/results.md.
// Deviations of a step's prior, metres and radians: about what moves between two frames.
constexpr double kMaxStep = 0.005, kMaxTurn = 0.03;
constexpr int kRepeats = 4;            // while the colours agree less than usual and better each time
constexpr double kUsual = 0.9;         // of the usual correlation
constexpr double kGain = 0.01;         // of the correlation, each time
constexpr int kExplainedMargin = 3;    // pixels
constexpr double kFreeSpaceFit = 0.5;  // what free space takes off how well a pose fits

}  // namespace

TrackVerification::TrackVerification(const PreparedModel& model, const ObjectModel& object,
                                     const VerificationParameters& parameters, const RgbdFrame& frame,
                                     const Pose& camera_from_object)
    : model_(model), object_(object), parameters_(parameters), frame_(frame), pose_(camera_from_object) {
  const cv::Rect box = modelBox(model, pose_, frame.depthCamera(), kMargin);
  if (!box.empty()) crop_ = std::make_unique<SceneCrop>(frame, box);
}

const TrackVerification::Coarse& TrackVerification::coarse() const {
  if (!coarse_) {
    coarse_.emplace();
    coarse_->seen = reproject(model_.coarse, pose_, view().half->camera);
    if (coarse_->seen.pixels > 0) coarse_->state = testDepth(coarse_->seen, *view().half, parameters_);
  }
  return *coarse_;
}

/// Where the model is not hidden: 255 over the box at half resolution.
cv::Mat TrackVerification::shown() const {
  const cv::Mat& state = coarse().state;
  cv::Mat shown = state == static_cast<int>(PixelState::kConsistent);
  shown |= state == static_cast<int>(PixelState::kUnknown);
  return shown;
}

DepthShares TrackVerification::look() const {
  DepthShares shares;
  if (!crop_) return shares;
  shares.outside = probeSurface(model_, kProbePoints, pose_, view()).outside;
  shares.pixels = coarse().seen.pixels;
  if (shares.pixels == 0) return shares;
  const auto share = [&](PixelState of) {
    return cv::countNonZero(coarse().state == static_cast<int>(of)) / static_cast<double>(shares.pixels);
  };
  shares.consistent = share(PixelState::kConsistent);
  shares.hidden = share(PixelState::kOccluded);
  shares.free_space = share(PixelState::kFreeSpace);
  shares.unknown = share(PixelState::kUnknown);
  return shares;
}

double TrackVerification::lightness() const {
  if (!crop_ || coarse().seen.pixels == 0) return 0.0;
  return cv::mean(view().half->lab(coarse().seen.box), shown())[0];
}

double TrackVerification::fitOf(const Pose& pose) const {
  const ProbeResult look = probeSurface(model_, kProbePoints, pose, view());
  return look.agreeing * (1.0 + look.correlation) - kFreeSpaceFit * look.free_space;
}

void TrackVerification::searchAround() {
  const cv::Rect box = modelBox(model_, pose_, frame_.depthCamera(), kSearchMargin);
  if (box.empty()) return;
  crop_ = std::make_unique<SceneCrop>(frame_, box);
  coarse_.reset();
  const Pose start = pose_;
  double best = fitOf(start);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      for (int z = -1; z <= 1; ++z) {
        Pose beside = start;
        beside.translation() += kSearchStep * Eigen::Vector3d(x, y, 0.5 * z);
        const Pose drawn = alignToDepth(model_, kProbePoints, beside, view());
        const double fit = fitOf(drawn);
        if (fit <= best) continue;
        best = fit;
        pose_ = drawn;
      }
}

double TrackVerification::colorsOf(const Pose& pose) const {
  return probeSurface(model_, kPeakPoints, pose, view()).correlation;
}

bool TrackVerification::align(bool use_lightness, double usual_colors) {
  if (!crop_) return false;
  RefinementOptions options;
  options.iterations = kIterations;
  options.samples = kSamples;
  options.use_features = false;
  options.use_lightness = use_lightness;
  options.lightness_from = 0;
  options.wants_frame_noise = true;
  options.max_step = kMaxStep;
  options.max_turn = kMaxTurn;
  colors_ = use_lightness ? colorsOf(pose_) : 0.0;
  for (int i = 0; i < kRepeats; ++i) {
    const Refinement refined = refinePose(model_, object_, Hypothesis(), pose_, view(), options);
    if (!refined.success) return i > 0;
    covariance_ = refined.covariance;
    frame_noise_ = refined.frame_noise;
    // What depth leaves open, as a can's rotation about its axis, would creep from frame to frame.
    const double reached = use_lightness ? colorsOf(refined.camera_from_object) : 0.0;
    if (use_lightness && reached < colors_) return true;
    coarse_.reset();
    pose_ = refined.camera_from_object;
    const bool goes_on = use_lightness && reached < kUsual * usual_colors && reached > colors_ + kGain;
    colors_ = reached;
    if (!goes_on) break;
  }
  return true;
}

Appearance TrackVerification::compareCoarsely() const {
  if (!crop_ || coarse().seen.pixels == 0) return {};
  const PosedModel posed(model_.coarse, coarse().seen, coarse().state, *view().half, AppearanceScale::ofHalf());
  return weighAppearance(posed, fitIllumination(posed));
}

Evidence TrackVerification::compare() const {
  Evidence evidence;
  if (!crop_) return evidence;
  const ReprojectedModel seen = reproject(model_, pose_, view().camera);
  if (seen.pixels == 0) return evidence;
  const cv::Mat state = testDepth(seen, view(), parameters_);
  const PosedModel posed(model_, seen, state, view());
  static_cast<Appearance&>(evidence) = weighAppearance(posed, fitIllumination(posed));
  const DepthFit depth = depthFit(posed);
  evidence.depth_fit = depth.fit;
  evidence.seen = depth.seen;
  evidence.peak = colorPeak(model_, kPeakPoints, pose_, view());
  return evidence;
}

ImagePart TrackVerification::explained() const {
  if (!crop_ || coarse().seen.pixels == 0) return {};
  ImagePart part{crop_->box(), cv::Mat::zeros(view().half->depth.size(), CV_8UC1)};
  shown().copyTo(part.mask(coarse().seen.box));
  cv::resize(part.mask, part.mask, part.box.size(), 0, 0, cv::INTER_NEAREST);
  const int side = 2 * kExplainedMargin + 1;
  cv::dilate(part.mask, part.mask, cv::Mat::ones(side, side, CV_8UC1));
  return part;
}

}  // namespace recognition
