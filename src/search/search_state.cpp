#include "search/search_state.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace recognition {
namespace {

constexpr int kExplainedMargin = 2;          // pixels
constexpr double kExplainedShare = 0.6;      // of a consensus set's features that lie on a better hypothesis
constexpr double kCompetingConsensus = 0.6;  // of the better one's inliers: a set that is as large may be the right one
constexpr double kSureConfidence = 0.8;      // of the better one

bool lies(const TestedHypothesis& accepted, const cv::Point& pixel) {
  const cv::Rect& box = accepted.reprojected.box;
  if (!box.contains(pixel)) return false;
  const auto state = accepted.pixels.state.at<PixelState>(pixel - box.tl());
  return state == PixelState::kConsistent || state == PixelState::kUnknown;
}

}  // namespace

SearchState::SearchState(cv::Size image_size, double work_ms)
    : explained_(image_size, CV_8UC1, cv::Scalar(0)), work_ms_(work_ms) {}

bool SearchState::choose(const AcceptanceRule& rule, const PreparedModels& models, const SceneView& scene,
                         std::vector<TestedHypothesis>* tested) {
  const auto passed = [](const TestedHypothesis& one) { return one.verified.accepted(); };
  if (std::none_of(tested->begin(), tested->end(), passed)) return false;  // the choice stands
  std::vector<TestedHypothesis*> pool;
  for (TestedHypothesis& earlier : accepted_) pool.push_back(&earlier);
  for (TestedHypothesis& one : *tested) pool.push_back(&one);
  rule.select(models, pool, scene);
  bool found = false;
  std::vector<TestedHypothesis> kept;
  for (TestedHypothesis& one : accepted_)
    if (passed(one)) kept.push_back(std::move(one));
  for (const TestedHypothesis& one : *tested) {
    if (!passed(one)) continue;
    found = true;
    kept.push_back(one);  // images are shared, not copied
  }
  accepted_ = std::move(kept);
  return found;
}

const TestedHypothesis* SearchState::explanationOf(const Hypothesis& hypothesis, const SceneView& scene) const {
  if (accepted_.empty() || hypothesis.consensus.empty()) return nullptr;
  std::vector<cv::Point> pixels;
  for (const Correspondence& pair : hypothesis.consensus) {
    const Keypoint& keypoint = scene.features->image.keypoints[static_cast<size_t>(pair.scene_feature)];
    const Eigen::Vector2d place = depthPixel(keypoint, scene.color_per_depth);
    pixels.emplace_back(cvRound(place.x()), cvRound(place.y()));
  }
  const auto size = static_cast<double>(pixels.size());
  for (const TestedHypothesis& one : accepted_) {
    if (one.verified.confidence < kSureConfidence) continue;
    if (size >= kCompetingConsensus * one.verified.evidence.inliers) continue;
    const auto on = std::count_if(pixels.begin(), pixels.end(), [&](const cv::Point& p) { return lies(one, p); });
    if (static_cast<double>(on) > kExplainedShare * size) return &one;
  }
  return nullptr;
}

cv::Mat explainedPixels(const std::vector<TestedHypothesis>& accepted, cv::Size image_size) {
  cv::Mat mask(image_size, CV_8UC1, cv::Scalar(0));
  for (const TestedHypothesis& one : accepted) {
    cv::Mat seen = one.pixels.state == static_cast<int>(PixelState::kConsistent);
    seen |= one.pixels.state == static_cast<int>(PixelState::kUnknown);
    mask(one.reprojected.box).setTo(255, seen);
  }
  const int size = 2 * kExplainedMargin + 1;
  cv::dilate(mask, mask, cv::Mat::ones(size, size, CV_8UC1));
  return mask;
}

}  // namespace recognition
