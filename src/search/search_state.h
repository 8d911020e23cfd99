#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "matching/algorithm2.h"
#include "rgbd_recognition/search/search_report.h"
#include "verification/acceptance_rule.h"
#include "verification/pose_verification.h"

namespace recognition {

/// What is found in a frame so far, which of its pixels that explains, and what it cost.
class SearchState {
 public:
  /// `work_ms`: budget in milliseconds of one core of 2.5 GHz, counted in work; 0: none.
  SearchState(cv::Size image_size, double work_ms);

  const std::vector<TestedHypothesis>& accepted() const { return accepted_; }
  /// CV_8UC1: 255 where an accepted hypothesis explains the pixel. A new one after each change.
  const cv::Mat& explained() const { return explained_; }
  SearchReport& report() { return report_; }
  const SearchReport& report() const { return report_; }

  /// Chooses among all that is accepted, earlier and now; the losers among `tested` are marked. True if something new
  /// was found.
  bool choose(const AcceptanceRule& rule, const PreparedModels& models, const SceneView& scene,
              std::vector<TestedHypothesis>* tested);
  /// Sets what is explained.
  void explain(cv::Mat explained) { explained_ = std::move(explained); }

  /// The accepted hypothesis that explains most of the features of a consensus set, if it explains most of them and is
  /// so much better that the set need not be tested; else null.
  const TestedHypothesis* explanationOf(const Hypothesis& hypothesis, const SceneView& scene) const;

  void spend(double milliseconds) { report_.work_ms += milliseconds; }
  bool exhausted() const { return work_ms_ > 0.0 && report_.work_ms >= work_ms_; }

 private:
  std::vector<TestedHypothesis> accepted_;
  cv::Mat explained_;
  double work_ms_;
  SearchReport report_;
};

/// Pixels (CV_8UC1, 255) that accepted hypotheses explain, in depth or as a hole, grown by two pixels: keypoints on an
/// outline are the object's own.
cv::Mat explainedPixels(const std::vector<TestedHypothesis>& accepted, cv::Size image_size);

}  // namespace recognition
