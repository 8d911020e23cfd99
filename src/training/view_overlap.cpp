#include "training/view_overlap.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr double kTurn = 360.0;      // degrees, as all below
constexpr double kWidestGap = 45.0;  // that neighbours bridge
constexpr double kWanted = 30.0;     // between neighbours
constexpr double kTolerance = 0.1;   // of the views needed
constexpr double kFromAbove = 0.97;  // sine of the elevation; such a view has no angle around z

std::vector<double> anglesAround(const std::vector<Eigen::Vector3f>& directions) {
  std::vector<double> angles;
  for (const Eigen::Vector3f& d : directions) {
    if (std::abs(d.normalized().z()) > kFromAbove) continue;
    const double angle = std::atan2(d.y(), d.x()) * 180.0 / kPi;
    angles.push_back(angle < 0.0 ? angle + kTurn : angle);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

std::string degrees(double angle) { return std::to_string(static_cast<int>(std::lround(std::fmod(angle, kTurn)))); }

}  // namespace

std::string missingViews(const std::vector<Eigen::Vector3f>& directions) {
  const std::vector<double> angles = anglesAround(directions);
  std::string where;
  int missing = 0;
  for (size_t i = 0; i < angles.size(); ++i) {
    const bool last = i + 1 == angles.size();
    const double end = last ? angles.front() + kTurn : angles[i + 1], gap = end - angles[i];
    if (gap <= kWidestGap) continue;
    const int more = static_cast<int>(std::ceil(gap / kWanted - kTolerance)) - 1;
    missing += more;
    where +=
        (where.empty() ? "" : ", ") + std::to_string(more) + " between " + degrees(angles[i]) + " and " + degrees(end);
  }
  if (missing == 0) return "";
  return std::to_string(directions.size()) + " views overlap too little: " + std::to_string(missing) +
         " more are needed, " + where + " degrees around z, counted from x towards y";
}

}  // namespace recognition
