#include "alignment/resting_shape.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/angles.h"

namespace recognition {
namespace {

constexpr int kDirections = 500;
constexpr float kNeighbourCosine = 0.968f;  // 14.5 degrees: some of the directions nearest to one
constexpr float kSameCosine = 0.966f;       // 15 degrees
constexpr float kGoldenAngle = 2.39996323f;
constexpr float kFirstStep = 0.1f, kLastStep = 0.01f;  // radians
constexpr int kTurns = 8;                              // directions in which a step is tried
constexpr float kGain = 1e-5f;                         // metres
constexpr size_t kMaxPoses = 24;

constexpr int kCells = 24;  // along each side of the unfolded octahedron

/// Evenly over the sphere.
std::vector<Eigen::Vector3f> spiral() {
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < kDirections; ++i) {
    const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / kDirections;
    const float radius = std::sqrt(1.0f - z * z), angle = kGoldenAngle * static_cast<float>(i);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

/// What may touch a plane: the points that reach farthest in one of the directions.
std::vector<Eigen::Vector3f> outermost(const std::vector<Eigen::Vector3f>& positions,
                                       const std::vector<Eigen::Vector3f>& directions) {
  Eigen::MatrixX3f all(static_cast<Eigen::Index>(positions.size()), 3);
  for (size_t i = 0; i < positions.size(); ++i) all.row(static_cast<Eigen::Index>(i)) = positions[i];
  std::vector<Eigen::Vector3f> points;
  Eigen::VectorXf reach;
  for (const Eigen::Vector3f& direction : directions) {
    reach.noalias() = all * direction;
    Eigen::Index farthest = 0;
    reach.maxCoeff(&farthest);
    points.push_back(positions[static_cast<size_t>(farthest)]);
  }
  return points;
}

float reachOf(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& direction) {
  float reach = direction.dot(points.front());
  for (const Eigen::Vector3f& point : points) reach = std::max(reach, direction.dot(point));
  return reach;
}

/// A body on a plane, by the direction into it.
struct Stand {
  float height = 0.0f;  ///< of the centre
  Eigen::Vector3f down;
};

/// Turns until no small turn lowers the centre.
void settle(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& centre, Stand* stand) {
  for (float step = kFirstStep; step > kLastStep;) {
    const Eigen::Vector3f a = stand->down.unitOrthogonal(), b = stand->down.cross(a);
    bool lower = false;
    for (int i = 0; i < kTurns && !lower; ++i) {
      const float angle = 2.0f * static_cast<float>(kPi) * static_cast<float>(i) / kTurns;
      const Eigen::Vector3f down = (stand->down + step * (std::cos(angle) * a + std::sin(angle) * b)).normalized();
      const float height = reachOf(points, down) - down.dot(centre);
      lower = height < stand->height - kGain;
      if (lower) *stand = {height, down};
    }
    if (!lower) step *= 0.5f;
  }
}

/// Whether no direction beside it is lower.
bool isLowest(const std::vector<Stand>& all, const Stand& stand) {
  return std::none_of(all.begin(), all.end(), [&](const Stand& other) {
    return other.height < stand.height && other.down.dot(stand.down) > kNeighbourCosine;
  });
}

/// An octahedron's faces unfolded onto the square -1..1.
Eigen::Vector2f unfold(const Eigen::Vector3f& direction) {
  const Eigen::Vector3f p = direction / direction.cwiseAbs().sum();
  if (p.z() >= 0.0f) return p.head<2>();
  return {(1.0f - std::abs(p.y())) * std::copysign(1.0f, p.x()), (1.0f - std::abs(p.x())) * std::copysign(1.0f, p.y())};
}

Eigen::Vector3f fold(const Eigen::Vector2f& place) {
  const float z = 1.0f - std::abs(place.x()) - std::abs(place.y());
  if (z >= 0.0f) return Eigen::Vector3f(place.x(), place.y(), z).normalized();
  return Eigen::Vector3f((1.0f - std::abs(place.y())) * std::copysign(1.0f, place.x()),
                         (1.0f - std::abs(place.x())) * std::copysign(1.0f, place.y()), z)
      .normalized();
}

int cellOf(float coordinate) {
  return std::clamp(static_cast<int>((coordinate + 1.0f) * 0.5f * kCells), 0, kCells - 1);
}

float centreOf(int cell) { return 2.0f * (static_cast<float>(cell) + 0.5f) / kCells - 1.0f; }

}  // namespace

std::vector<RestingPose> restingPoses(const std::vector<Eigen::Vector3f>& positions, const Eigen::Vector3f& centre) {
  const std::vector<Eigen::Vector3f> directions = spiral(), points = outermost(positions, directions);
  std::vector<Stand> all, lowest;
  for (const Eigen::Vector3f& down : directions) all.push_back({reachOf(points, down) - down.dot(centre), down});
  for (const Stand& stand : all)
    if (isLowest(all, stand)) lowest.push_back(stand);
  for (Stand& stand : lowest) settle(points, centre, &stand);
  std::stable_sort(lowest.begin(), lowest.end(), [](const Stand& a, const Stand& b) { return a.height < b.height; });
  std::vector<RestingPose> poses;
  for (const Stand& stand : lowest) {
    if (poses.size() == kMaxPoses) break;
    const auto same = [&](const RestingPose& other) { return other.down.dot(stand.down) > kSameCosine; };
    if (std::none_of(poses.begin(), poses.end(), same)) poses.push_back({stand.down, reachOf(points, stand.down)});
  }
  return poses;
}

FaceTable::FaceTable(const std::vector<Eigen::Vector3f>& positions, const std::vector<Eigen::Vector3f>& normals,
                     const std::vector<Eigen::Vector3f>& lab, double angle) {
  const auto min_cosine = static_cast<float>(std::cos(angle * kPi / 180.0));
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const Eigen::Vector3f direction = fold({centreOf(column), centreOf(row)});
      Face face;
      int count = 0;
      for (size_t i = 0; i < positions.size(); ++i) {
        if (normals[i].dot(direction) < min_cosine) continue;
        face.centroid += positions[i];
        face.lab += lab[i];
        ++count;
      }
      if (count > 0) {
        face.centroid /= static_cast<float>(count);
        face.lab /= static_cast<float>(count);
      }
      face.share = static_cast<float>(count) / static_cast<float>(positions.size());
      faces_.push_back(face);
    }
  }
}

const FaceTable::Face& FaceTable::facing(const Eigen::Vector3f& direction) const {
  const Eigen::Vector2f place = unfold(direction);
  return faces_[static_cast<size_t>(cellOf(place.y())) * kCells + static_cast<size_t>(cellOf(place.x()))];
}

}  // namespace recognition
