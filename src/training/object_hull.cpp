#include "training/object_hull.h"

#include <algorithm>
#include <cmath>

#include "core/depth_noise.h"
#include "core/point_grid.h"

namespace recognition {
namespace {

constexpr int kMaxCells = 600000;
constexpr int kMinViews = 2;             // that see through what is carved
constexpr float kSeenAlong = 2.5f;       // in spacings: the hull's surface is seen where the cloud is so near along its
constexpr float kSeenAcross = 1.0f;      // normal, and across
constexpr float kLowestCarved = 0.004f;  // metres above the board where views still tell it from what is on it
constexpr int kNormalCells = 2;          // cells

constexpr float kDensityRadius = 3.0f;  // in spacings, over which the density of points is counted
constexpr float kRepetitions = 100.0f;  // of a point that has no other about it
constexpr float kOtherSide = -0.5f;     // cosine between normals of a thin wall's two sides, and less

// Cells of a box; what the views leave of it.
class Hull {
 public:
  Hull(const std::vector<SurfacePoint>& cloud, float spacing) {
    Eigen::Vector3f low = cloud.front().position, high = low;
    for (const SurfacePoint& point : cloud) low = low.cwiseMin(point.position), high = high.cwiseMax(point.position);
    low.z() = 0.0f;
    const Eigen::Vector3f sizes = (high - low).array() + 2.0f * spacing;
    cell_ = std::max(spacing, std::cbrt(sizes.prod() / static_cast<float>(kMaxCells)));
    low_ = low - Eigen::Vector3f(spacing, spacing, 0.0f);
    count_ = (sizes / cell_).array().ceil().cast<int>();
    filled_.assign(static_cast<size_t>(count_.prod()), 1);
  }

  float cell() const { return cell_; }
  const Eigen::Vector3i& count() const { return count_; }
  Eigen::Vector3f centreOf(const Eigen::Vector3i& at) const {
    return low_ + cell_ * (at.cast<float>().array() + 0.5f).matrix();
  }
  bool isFilled(const Eigen::Vector3i& at) const {
    return (at.array() >= 0).all() && (at.array() < count_.array()).all() && filled_[indexOf(at)] != 0;
  }

  void carve(const std::vector<ObjectView>& views, float lowest) {
    std::vector<cv::Mat> nearest;
    for (const ObjectView& view : views) nearest.push_back(nearestDepthAround(view.depth));
    const int bottom = std::clamp(static_cast<int>(std::ceil(lowest / cell_ - 0.5f)), 0, count_.z() - 1);
    cv::parallel_for_(cv::Range(bottom, count_.z()), [&](const cv::Range& range) {
      for (int z = range.start; z < range.end; ++z)
        for (int y = 0; y < count_.y(); ++y)
          for (int x = 0; x < count_.x(); ++x)
            if (isFree({x, y, z}, views, nearest)) filled_[indexOf({x, y, z})] = 0;
    });
    const auto layer = static_cast<std::ptrdiff_t>(count_.x()) * count_.y();
    for (int z = 0; z < bottom; ++z) std::copy_n(filled_.begin() + bottom * layer, layer, filled_.begin() + z * layer);
  }

  // Away from what is filled; its length is of no meaning.
  Eigen::Vector3f normalAt(const Eigen::Vector3i& at) const {
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    for (int z = -kNormalCells; z <= kNormalCells; ++z)
      for (int y = -kNormalCells; y <= kNormalCells; ++y)
        for (int x = -kNormalCells; x <= kNormalCells; ++x) {
          const Eigen::Vector3i step(x, y, z);
          if (!isFilled(at + step)) normal += step.cast<float>();
        }
    return normal;
  }

 private:
  size_t indexOf(const Eigen::Vector3i& at) const {
    return static_cast<size_t>((at.z() * count_.y() + at.y()) * count_.x() + at.x());
  }

  // Near the surface that a view measures, it votes for either side of it, so that noise averages out.
  bool isFree(const Eigen::Vector3i& at, const std::vector<ObjectView>& views,
              const std::vector<cv::Mat>& nearest) const {
    const Eigen::Vector3f centre = centreOf(at);
    int before = 0, behind = 0;
    for (size_t i = 0; i < views.size(); ++i) {
      const auto seen = views[i].find(centre);
      if (!seen) continue;
      const double z = seen->position.z(), doubt = cell_ + 3.0 * depthSigma(z);
      if (seen->gap > doubt)
        before += nearest[i].at<float>(seen->pixel) > z ? 1 : 0;
      else if (seen->gap > -doubt)
        ++(seen->gap > 0.0 ? before : behind);
    }
    return before >= std::min(kMinViews, static_cast<int>(views.size())) && before > behind;
  }

  float cell_ = 0.0f;
  Eigen::Vector3f low_;
  Eigen::Vector3i count_;
  std::vector<uchar> filled_;
};

// Points of the hull's surface: one a face of a cell, as far as the face's share of the surface goes.
std::vector<SurfacePoint> surfaceOf(const Hull& hull, float spacing) {
  std::vector<SurfacePoint> points;
  const float faces = hull.cell() * hull.cell() / (spacing * spacing);  // points a cell's face
  float due = 0.0f;
  Eigen::Vector3i at;
  for (at.z() = 0; at.z() < hull.count().z(); ++at.z())
    for (at.y() = 0; at.y() < hull.count().y(); ++at.y())
      for (at.x() = 0; at.x() < hull.count().x(); ++at.x()) {
        if (!hull.isFilled(at)) continue;
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        for (int side = 0; side < 6; ++side) {
          Eigen::Vector3i step = Eigen::Vector3i::Zero();
          step[side / 2] = side % 2 ? 1 : -1;
          if (hull.isFilled(at + step)) continue;
          if (normal.isZero()) normal = hull.normalAt(at).normalized();
          due += faces * std::max(0.0f, normal.dot(step.cast<float>()));
          for (; due >= 1.0f; due -= 1.0f)
            points.push_back({hull.centreOf(at) + 0.5f * hull.cell() * step.cast<float>(), normal, {}});
        }
      }
  return points;
}

}  // namespace

std::vector<SurfacePoint> estimateUnseen(const std::vector<ObjectView>& views, const std::vector<SurfacePoint>& cloud,
                                         float lowest, float spacing) {
  if (cloud.empty()) return {};
  Hull hull(cloud, spacing);
  hull.carve(views, std::min(lowest, kLowestCarved));
  const float unit = std::max(spacing, hull.cell()), reach = kSeenAlong * unit;
  PointGrid seen(reach);
  for (size_t i = 0; i < cloud.size(); ++i) seen.insert(cloud[i].position, static_cast<int>(i));
  std::vector<SurfacePoint> unseen;
  for (const SurfacePoint& point : surfaceOf(hull, spacing)) {
    bool near = false;
    const bool is_high = point.position.z() > lowest + spacing;  // gaps between points there are none below them
    seen.forNeighbours(point.position, [&](int i) {
      const SurfacePoint& other = cloud[static_cast<size_t>(i)];
      const Eigen::Vector3f offset = other.position - point.position;
      const float along = offset.dot(point.normal);
      const float across = (offset - along * point.normal).norm();
      near = near || (other.normal.dot(point.normal) > 0.0f && std::abs(along) < reach &&
                      (across < kSeenAcross * unit || (is_high && offset.norm() < reach)));
    });
    if (!near) unseen.push_back(point);
  }
  return unseen;
}

Extents computeEvenExtents(const std::vector<SurfacePoint>& cloud, float spacing) {
  const float radius = kDensityRadius * spacing;
  PointGrid grid(radius);
  for (size_t i = 0; i < cloud.size(); ++i) grid.insert(cloud[i].position, static_cast<int>(i));
  std::vector<SurfacePoint> even;  // each point as often as it is due
  float due = 0.0f;
  for (const SurfacePoint& point : cloud) {
    int around = 0;
    grid.forNeighbours(point.position, [&](int i) {
      const SurfacePoint& other = cloud[static_cast<size_t>(i)];
      around += other.normal.dot(point.normal) > kOtherSide && (other.position - point.position).norm() < radius;
    });
    for (due += kRepetitions / static_cast<float>(around); due >= 1.0f; due -= 1.0f) even.push_back(point);
  }
  return computeExtents(even.size() < 4 ? cloud : even);
}

}  // namespace recognition
