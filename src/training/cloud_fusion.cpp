#include "training/cloud_fusion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "training/cloud_finder.h"
#include "core/point_grid.h"
#include "meshes/surface_sampling.h"
#include "training/small_motion.h"

namespace recognition {
namespace {

constexpr float kSeenThrough = 0.012f;  // metres by which a view's depth must lie behind a point
constexpr int kMinNeighbours = 3;       // within three spacings
constexpr float kThinning = 0.72f;      // least distance of points, in spacings
constexpr int kWitnesses = 3;           // views that measured what counts as seen through
constexpr int kViewsAWitness = 6;       // fewer of few views
constexpr float kThickness = 0.006f;    // metres, of the layer of points that one surface makes
constexpr float kFacingUp = 0.7f;       // cosine between the normal of what lies like the board and the vertical
constexpr double kMinPairs = 50.0;      // below, a view stays where it is

struct CellKey {
  int x, y, z, side;  // side: the normal's main direction, 0 to 5
  bool operator<(const CellKey& o) const { return std::tie(x, y, z, side) < std::tie(o.x, o.y, o.z, o.side); }
};

struct Cell {
  Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero(), rgb = Eigen::Vector3f::Zero();
  float weight = 0.0f, color_weight = 0.0f;
  int views = 0, last_view = -1, inner_views = 0, last_inner_view = -1;
};

int mainSide(const Eigen::Vector3f& normal) {
  Eigen::Index axis;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * static_cast<int>(axis) + (normal[axis] > 0.0f ? 1 : 0);
}

FusedPoint average(const Cell& cell) {
  const Eigen::Vector3f rgb = cell.rgb / cell.color_weight;
  return {
      {cell.position / cell.weight, cell.normal.normalized(),
       cv::Vec3b(cv::saturate_cast<uchar>(rgb[0]), cv::saturate_cast<uchar>(rgb[1]), cv::saturate_cast<uchar>(rgb[2]))},
      cell.views,
      cell.inner_views};
}

// kHidden: or at a depth edge, which wanders.
enum class Sight { kOutside, kHidden, kAgrees, kThrough };

Sight look(const ObjectView& view, const cv::Mat& nearest, const SurfacePoint& point) {
  const auto seen = view.find(point.position);
  if (!seen) return Sight::kOutside;
  if (nearest.at<float>(seen->pixel) > seen->position.z() + kSeenThrough) return Sight::kThrough;
  return std::abs(seen->gap) < kSeenThrough ? Sight::kAgrees : Sight::kHidden;
}

// Where a point may be the board's, to which noise has lent height: whether more views measure the board there.
bool isBoard(const std::vector<ObjectView>& views, const SurfacePoint& point, float highest) {
  if (point.position.z() > highest || point.normal.z() < kFacingUp) return false;
  int object = 0, board = 0;
  for (const ObjectView& view : views) {
    const auto seen = view.find(point.position);
    if (!seen) continue;
    if (view.mask.at<uchar>(seen->pixel) > 0)
      object += std::abs(seen->gap) < kSeenThrough ? 1 : 0;
    else
      board += std::abs(view.worldPoint(seen->pixel.x, seen->pixel.y).z()) < highest ? 1 : 0;
  }
  return board > object;
}

std::vector<const FusedPoint*> withNeighbours(const std::vector<const FusedPoint*>& points, float spacing) {
  PointGrid grid(3.0f * spacing);
  for (size_t i = 0; i < points.size(); ++i) grid.insert(points[i]->surface.position, static_cast<int>(i));
  std::vector<const FusedPoint*> kept;
  for (const FusedPoint* point : points) {
    int neighbours = -1;  // itself
    grid.forNeighbours(point->surface.position, [&](int i) {
      const SurfacePoint& other = points[static_cast<size_t>(i)]->surface;
      neighbours += (other.position - point->surface.position).norm() < 3.0f * spacing &&
                    other.normal.dot(point->surface.normal) > 0.3f;
    });
    if (neighbours >= kMinNeighbours) kept.push_back(point);
  }
  return kept;
}

// One step of a view to the cloud, held to its first pose; the distances of the pairs are appended.
void step(ObjectView& view, const Pose& first, const std::vector<Surfel>& surfels, const CloudFinder& cloud,
          double pose_sigma, std::vector<float>& distances) {
  const Pose world_from_camera = view.camera_from_world.inverse();
  SmallMotion motion;  // of the view's points in the world
  for (const Surfel& s : surfels)
    motion.centre += world_from_camera * s.position.cast<double>() / static_cast<double>(surfels.size());
  for (const Surfel& s : surfels) {
    const Eigen::Vector3d p = world_from_camera * s.position.cast<double>();
    const Eigen::Vector3d n = world_from_camera.linear() * s.normal.cast<double>();
    if (const SurfacePoint* pair = cloud.nearest(p.cast<float>(), n.cast<float>()))
      distances.push_back(static_cast<float>(motion.addPair(p, *pair)));
  }
  if (motion.pairs < kMinPairs) return;
  motion.addPrior(first.inverse() * view.camera_from_world, pose_sigma);
  view.camera_from_world = view.camera_from_world * motion.solve().inverse();
}

}  // namespace

std::vector<FusedPoint> fuseSurfaces(const std::vector<ObjectView>& views,
                                     const std::vector<std::vector<Surfel>>& surfels, float spacing) {
  std::map<CellKey, Cell> cells;
  for (size_t view = 0; view < views.size(); ++view) {
    const Pose world_from_camera = views[view].camera_from_world.inverse();
    for (const Surfel& s : surfels[view]) {
      const Eigen::Vector3f p = (world_from_camera * s.position.cast<double>()).cast<float>();
      const Eigen::Vector3f n = (world_from_camera.linear() * s.normal.cast<double>()).cast<float>();
      const Eigen::Vector3i at = (p / spacing).array().floor().cast<int>();
      Cell& cell = cells[{at.x(), at.y(), at.z(), mainSide(n)}];
      const float cosine = -s.normal.dot(s.position.normalized());
      const float color_weight = s.weight * cosine * cosine;
      cell.position += s.weight * p;
      cell.normal += s.weight * n;
      cell.rgb += color_weight * Eigen::Vector3f(s.rgb[0], s.rgb[1], s.rgb[2]);
      cell.weight += s.weight;
      cell.color_weight += color_weight;
      if (cell.last_view != static_cast<int>(view)) ++cell.views;
      cell.last_view = static_cast<int>(view);
      if (s.inner && cell.last_inner_view != static_cast<int>(view)) {
        ++cell.inner_views;
        cell.last_inner_view = static_cast<int>(view);
      }
    }
  }
  std::vector<FusedPoint> fused;
  for (const auto& [key, cell] : cells) fused.push_back(average(cell));
  return fused;
}

std::vector<SurfacePoint> surfacesOf(const std::vector<FusedPoint>& fused) {
  std::vector<SurfacePoint> points;
  for (const FusedPoint& point : fused) points.push_back(point.surface);
  return points;
}

std::vector<SurfacePoint> cleanCloud(const std::vector<ObjectView>& views, const std::vector<FusedPoint>& fused,
                                     int min_views, float spacing, float highest_board, double& carved) {
  std::vector<char> keep(fused.size(), 0);
  std::vector<char> seen_through(fused.size(), 0);
  std::vector<cv::Mat> nearest;
  for (const ObjectView& view : views) nearest.push_back(nearestDepthAround(view.depth));
  cv::parallel_for_(cv::Range(0, static_cast<int>(fused.size())), [&](const cv::Range& range) {
    for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i) {
      int through = 0, looking = 0;
      for (size_t view = 0; view < views.size(); ++view) {
        const Sight sight = look(views[view], nearest[view], fused[i].surface);
        through += sight == Sight::kThrough;
        looking += sight == Sight::kAgrees || sight == Sight::kThrough;
      }
      seen_through[i] = through > fused[i].views;
      keep[i] = !seen_through[i] && fused[i].views >= std::min(min_views, looking) &&
                !isBoard(views, fused[i].surface, highest_board);
    }
  });
  std::vector<const FusedPoint*> order;
  for (size_t i = 0; i < fused.size(); ++i)
    if (keep[i]) order.push_back(&fused[i]);
  std::stable_sort(order.begin(), order.end(),
                   [](const FusedPoint* a, const FusedPoint* b) { return a->views > b->views; });
  const int witnesses = std::min(kWitnesses, 1 + static_cast<int>(views.size()) / kViewsAWitness);
  double seen = 0.0, through = 0.0;
  for (size_t i = 0; i < fused.size(); ++i) {
    if (fused[i].inner_views < witnesses) continue;  // stray points beside the object
    seen += fused[i].inner_views;
    through += seen_through[i] ? fused[i].inner_views : 0;
  }
  carved = seen > 0.0 ? through / seen : 0.0;
  std::vector<SurfacePoint> points;
  std::vector<float> weights;
  for (const FusedPoint* point : withNeighbours(order, spacing)) {
    points.push_back(point->surface);
    weights.push_back(static_cast<float>(point->views));
  }
  return thinMeasuredSurface(points, weights, kThinning * spacing, kThickness);
}

double alignViews(std::vector<ObjectView>& views, const std::vector<std::vector<Surfel>>& surfels, int rounds,
                  float distance, double pose_sigma, float spacing, const std::function<void(double)>& progress) {
  std::vector<Pose> first;
  for (const ObjectView& view : views) first.push_back(view.camera_from_world);
  std::vector<float> all;
  for (int round = 0; round <= rounds; ++round) {
    progress(static_cast<double>(round) / (rounds + 1));
    const std::vector<SurfacePoint> cloud = surfacesOf(fuseSurfaces(views, surfels, spacing));
    const CloudFinder finder(cloud, distance);
    std::vector<std::vector<float>> distances(views.size());
    std::vector<ObjectView> moved = views;
    cv::parallel_for_(cv::Range(0, static_cast<int>(views.size())), [&](const cv::Range& range) {
      for (auto i = static_cast<size_t>(range.start); i < static_cast<size_t>(range.end); ++i)
        step(moved[i], first[i], surfels[i], finder, pose_sigma, distances[i]);
    });
    all.clear();
    for (const auto& some : distances) all.insert(all.end(), some.begin(), some.end());
    if (round < rounds) views = std::move(moved);
  }
  if (all.empty()) return 0.0;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  return static_cast<double>(all[all.size() / 2]);
}

}  // namespace recognition
