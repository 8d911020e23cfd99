#include "training/training_quality.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "meshes/surface_sampling.h"

namespace recognition {
namespace {

constexpr double kMuchOverexposed = 0.2;  // of the object's pixels
constexpr double kCoverageAngle = 20.0;   // degrees
constexpr int kDirections = 400;
constexpr int kFewFeatures = 150;
constexpr int kFewViews = 3;
constexpr double kCoarseResidual = 0.003;  // metres
constexpr double kMuchCarved = 0.02;
constexpr double kTopHeight = 0.8;  // sine of the elevation from which the top is seen well, 53 degrees
constexpr double kLittleCoverage = 0.5;

}  // namespace

bool isCovered(const Eigen::Vector3f& direction, const std::vector<Eigen::Vector3f>& view_directions) {
  static const auto kMinCosine = static_cast<float>(std::cos(kCoverageAngle * kPi / 180.0));
  return std::any_of(view_directions.begin(), view_directions.end(),
                     [&](const Eigen::Vector3f& d) { return d.dot(direction) > kMinCosine; });
}

double coverageOf(const std::vector<Eigen::Vector3f>& view_directions) {
  int upper = 0, covered = 0;
  for (const Eigen::Vector3f& direction : sphereDirections(kDirections)) {
    if (direction.z() < 0.0f) continue;
    ++upper;
    covered += isCovered(direction, view_directions);
  }
  return static_cast<double>(covered) / upper;
}

std::vector<std::string> findWarnings(const ObjectModel& model, const TrainingReport& report,
                                      const std::vector<Eigen::Vector3f>& view_directions) {
  std::vector<std::string> warnings;
  const auto sees_top = [](const Eigen::Vector3f& d) { return d.z() > kTopHeight; };
  if (report.views_used < kFewViews) {
    warnings.push_back("made from " + std::to_string(report.views_used) + " views only: a partial model");
  } else if (std::none_of(view_directions.begin(), view_directions.end(), sees_top)) {
    warnings.push_back("the top was not seen well");
  }
  if (report.views_used >= kFewViews && report.coverage < kLittleCoverage)
    warnings.push_back("seen from " + std::to_string(static_cast<int>(100.0 * report.coverage)) +
                       " % of all directions only");
  for (const auto& [type, features] : model.features)
    if (features.count() < kFewFeatures)
      warnings.push_back("little texture (" + std::to_string(features.count()) + " " + descriptorName(type) +
                         " features): expect detections only within 0.7 m");
  if (report.overexposed > kMuchOverexposed)
    warnings.push_back("overexposed: " + std::to_string(static_cast<int>(100.0 * report.overexposed)) +
                       " % of the object is too bright for the camera, and its texture is lost; lower the exposure");
  if (report.residual > kCoarseResidual)
    warnings.push_back("the views disagree by " + std::to_string(static_cast<int>(1000.0 * report.residual)) +
                       " mm: did the object move on the board?");
  if (report.carved > kMuchCarved)
    warnings.push_back("many views see through what others measured: did the object move on the board?");
  return warnings;
}

}  // namespace recognition
