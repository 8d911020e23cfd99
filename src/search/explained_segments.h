#pragma once

#include <set>

#include "rgbd_recognition/segmentation/segmentation.h"
#include "verification/pose_verification.h"

namespace recognition {

/// Sec. VI, for further rounds: labels of the segments of accepted hypotheses, S* of each and those of which more than
/// half agrees in depth and colour (f(S) / |S| of eq. (14)).
std::set<int> explainedSegments(const std::vector<TestedHypothesis>& accepted, const Segmentation& segmentation);

/// S of a further round: the labels of these segments are taken off.
Segmentation without(const Segmentation& segmentation, const std::set<int>& labels);

/// CV_8UC1: 255 on these segments.
cv::Mat maskOf(const Segmentation& segmentation, const std::set<int>& labels);

}  // namespace recognition
