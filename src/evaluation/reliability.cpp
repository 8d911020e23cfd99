#include "evaluation/reliability.h"

#include <Eigen/Dense>

namespace recognition {
namespace {

constexpr double kMedian = 5.348, kQuantile95 = 12.592;  // of a chi-square with six degrees of freedom

ReliabilityBands::Band& bandOf(ReliabilityBands& bands, double confidence) {
  size_t band = 0;
  while (band + 1 < kReliabilityBands && confidence > kReliabilityBandEnds[band]) ++band;
  return bands.bands[band];
}

bool isNear(const Hit& hit) { return hit.translation_error < kNearTranslation && hit.rotation_error < kNearRotation; }

}  // namespace

std::map<std::string, ReliabilityBands> reliabilityOf(const std::vector<FrameRecord>& records) {
  std::map<std::string, ReliabilityBands> reliability;
  for (const FrameRecord& record : records) {
    std::vector<bool> hits(record.detections.size(), false), near(record.detections.size(), false);
    for (const Hit& hit : scoreOf(record).hits) {
      hits[static_cast<size_t>(hit.detection)] = true;
      near[static_cast<size_t>(hit.detection)] = isNear(hit);
    }
    for (size_t i = 0; i < record.detections.size(); ++i) {
      const HypothesisRecord& detection = record.detections[i];
      ReliabilityBands::Band& band = bandOf(reliability[detection.source], detection.confidence);
      ++band.detections;
      band.right += near[i] ? 1 : 0;
      band.moved += hits[i] && !near[i] ? 1 : 0;
      band.confidence_sum += detection.confidence;
    }
  }
  return reliability;
}

double normalisedError(const Pose& found, const Eigen::Matrix<double, 6, 6>& covariance, const Pose& truth) {
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(covariance);
  if (solver.info() != Eigen::Success || !solver.isPositive() || solver.vectorD().minCoeff() <= 0.0) return -1.0;
  const Eigen::AngleAxisd turn(truth.linear() * found.linear().transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << truth.translation() - found.translation(), turn.angle() * turn.axis();
  return error.dot(solver.solve(error));
}

CovarianceConsistency consistencyOf(const std::vector<FrameRecord>& records) {
  CovarianceConsistency result;
  for (const FrameRecord& record : records)
    for (const Hit& hit : scoreOf(record).hits) {
      const HypothesisRecord& detection = record.detections[static_cast<size_t>(hit.detection)];
      const Pose& truth = record.truth[static_cast<size_t>(hit.truth)].camera_from_object;
      const double error = normalisedError(detection.camera_from_object, detection.covariance, truth);
      if (!isNear(hit) || error < 0.0) continue;
      ++result.poses;
      result.within_median += error < kMedian ? 1 : 0;
      result.within_95 += error < kQuantile95 ? 1 : 0;
    }
  return result;
}

}  // namespace recognition
