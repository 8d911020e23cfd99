#include "rgbd_recognition/evaluation/miss_cause.h"
#include "evaluation/oracle.h"
#include "rgbd_recognition/core/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

/// Pixels where the model at this pose is seen: it projects there facing the camera, and the scene is not more than 3
/// cm off in depth.
cv::Mat visibleMask(const ObjectModel& model, const Pose& camera_from_object, const CameraModel& camera,
                    const cv::Mat& depth) {
  cv::Mat mask = cv::Mat::zeros(depth.size(), CV_8UC1);
  for (const SurfacePoint& point : model.cloud) {
    const Eigen::Vector3d p = camera_from_object * point.position.cast<double>();
    const Eigen::Vector3d n = camera_from_object.linear() * point.normal.cast<double>();
    if (p.z() < 0.05 || n.dot(p) >= 0.0) continue;
    const Eigen::Vector2d m = camera.project(p);
    const cv::Point pixel(cvRound(m.x()), cvRound(m.y()));
    if (!cv::Rect({0, 0}, depth.size()).contains(pixel)) continue;
    const float z = depth.at<float>(pixel);
    if (z <= 0.0f || std::abs(z - p.z()) < 0.03) mask.at<std::uint8_t>(pixel) = 255;
  }
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8UC1));
  return mask;
}

double segmentedShare(const cv::Mat& mask, const cv::Mat& labels) {
  const int all = cv::countNonZero(mask);
  const int inside = cv::countNonZero(mask & (labels >= 1));
  return all > 0 ? static_cast<double>(inside) / all : 0.0;
}

std::vector<bool> featuresOn(const SceneFeatures& features, const cv::Mat& mask, int color_per_depth) {
  std::vector<bool> on(features.image.keypoints.size(), false);
  for (size_t i = 0; i < on.size(); ++i) {
    const Keypoint& k = features.image.keypoints[i];
    const cv::Point pixel(cvRound(k.x) / color_per_depth, cvRound(k.y) / color_per_depth);
    on[i] = cv::Rect({0, 0}, mask.size()).contains(pixel) && mask.at<std::uint8_t>(pixel) != 0;
  }
  return on;
}

std::string describe(const VerifiedHypothesis& h) {
  char text[256];
  std::snprintf(text, sizeof text, "%s: s_d %.2f, s_c %.2f, s_o %.2f, total %.2f, visible %.2f, consensus %zu%s%s",
                rejectionName(h.rejection), h.scores.s_d, h.scores.s_c, h.scores.s_o, h.scores.total, h.scores.visible,
                h.hypothesis.consensus.size(), h.conflict_with.empty() ? "" : ", won by ", h.conflict_with.c_str());
  return text;
}

}  // namespace

const char* missCauseName(MissCause cause) {
  static constexpr std::array<const char*, kMissCauses> names = {"found",       "not_trained",         "segmentation",
                                                                 "no_features", "few_correspondences", "no_consensus",
                                                                 "failed_test", "lost_conflict"};
  return names.at(static_cast<size_t>(cause));
}

bool isNear(const Pose& a, const Pose& b) {
  return translationDistance(a, b) < kNearTranslation && rotationDistance(a, b) * 180.0 / M_PI < kNearRotation;
}

namespace {

constexpr double kSegmentedShare = 0.2;  // of an instance, below which segmentation lost it

}  // namespace

InstanceTrace traceInstance(const RgbdFrame& frame, const RecognitionResult& result, const ModelDatabase& database,
                            int object, const Pose& camera_from_object, bool found) {
  InstanceTrace trace;
  if (object < 0) return trace;
  const ObjectModel& model = *database.objects.at(static_cast<size_t>(object));
  const cv::Mat mask = visibleMask(model, camera_from_object, frame.depthCamera(), depthInMetres(frame.depth));
  const std::vector<bool> on = featuresOn(result.features, mask, frame.colorPerDepthPixel());
  trace.visible_pixels = cv::countNonZero(mask);
  trace.segmented = segmentedShare(mask, result.segmentation.labels);
  trace.features = static_cast<int>(std::count(on.begin(), on.end(), true));
  trace.correct_correspondences =
      static_cast<int>(correctCorrespondences(result, model, object, camera_from_object).size());

  const VerifiedHypothesis* best = nullptr;  // the one that got farthest, then the one with most support
  for (const VerifiedHypothesis& h : result.hypotheses) {
    if (h.hypothesis.object != object || !(isNear(h.hypothesis.camera_from_object, camera_from_object) ||
                                           isNear(h.camera_from_object, camera_from_object)))
      continue;
    trace.best_consensus = std::max(trace.best_consensus, static_cast<int>(h.hypothesis.consensus.size()));
    if (!best || h.scores.total > best->scores.total) best = &h;
  }
  if (best) trace.detail = describe(*best);

  const bool conflict = best && (best->rejection == Rejection::kConflict || best->rejection == Rejection::kDuplicate);
  if (found)
    trace.cause = MissCause::kFound;
  else if (best)
    trace.cause = conflict ? MissCause::kLostConflict : MissCause::kFailedTest;
  else if (trace.segmented < kSegmentedShare)
    trace.cause = MissCause::kSegmentation;
  else if (trace.features < 3)
    trace.cause = MissCause::kNoFeatures;
  else if (trace.correct_correspondences < 3)
    trace.cause = MissCause::kFewCorrespondences;
  else
    trace.cause = MissCause::kNoConsensus;
  return trace;
}

}  // namespace recognition
