#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "rgbd_recognition/evaluation/report.h"

namespace recognition {

/// Accepted hypotheses of each source, by confidence: Report::reliability.
std::map<std::string, ReliabilityBands> reliabilityOf(const std::vector<FrameRecord>& records);

/// Normalised errors of the detections that lie within 3 cm and 20 degrees of the truth: Report::consistency.
CovarianceConsistency consistencyOf(const std::vector<FrameRecord>& records);

/// e^T C^-1 e of the error of a pose: of the object's origin and of the rotation, in the camera's axes. Chi-square with
/// six degrees of freedom, if the covariance is right. Negative where the covariance cannot be inverted.
double normalisedError(const Pose& found, const Eigen::Matrix<double, 6, 6>& covariance, const Pose& truth);

}  // namespace recognition
