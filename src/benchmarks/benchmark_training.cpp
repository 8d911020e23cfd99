// benchmark_training: a model trained from a simulated turntable recording against the mesh that was recorded.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "training/small_motion.h"
#include "core/point_grid.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "rgbd_recognition/model/model_store.h"
#include "meshes/surface_sampling.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

constexpr double kSampleSpacing = 0.0015;  // of the mesh, metres
constexpr int kMaxSamples = 400000;
constexpr float kReach = 0.012f;      // farthest pairing of cloud and mesh, metres
constexpr float kSameFace = 0.7f;     // least cosine between normals that are paired
constexpr float kCovered = 0.005f;    // a place of the surface is covered by a point as near as this
constexpr double kSeenDepth = 0.006;  // metres between depth image and surface where the camera saw it
constexpr float kMinCosine = 0.25f;   // of the slant at which it is seen
constexpr int kRounds = 30;

struct Surface {
  std::vector<SurfacePoint> points;  // mesh frame
  PointGrid grid{kReach};

  explicit Surface(const std::vector<SurfacePoint>& cloud) : points(cloud) {
    for (size_t i = 0; i < points.size(); ++i) grid.insert(points[i].position, static_cast<int>(i));
  }
  const SurfacePoint* nearest(const Eigen::Vector3f& p) const {
    return nearestIf(p, [](const SurfacePoint&) { return true; });
  }
  // Of the same face: beside an edge, the nearest point may be of the other, and pull the wrong way.
  const SurfacePoint* nearestFacing(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const {
    return nearestIf(p, [&](const SurfacePoint& point) { return point.normal.dot(normal) > kSameFace; });
  }

 private:
  template <typename Condition>
  const SurfacePoint* nearestIf(const Eigen::Vector3f& p, const Condition& condition) const {
    const SurfacePoint* best = nullptr;
    float best_distance = kReach * kReach;
    grid.forNeighbours(p, [&](int i) {
      const SurfacePoint& point = points[static_cast<size_t>(i)];
      const float d = (point.position - p).squaredNorm();
      if (d < best_distance && condition(point)) best_distance = d, best = &point;
    });
    return best;
  }
};

// Point-to-plane ICP; the model has the mesh's frame but for what training erred.
Pose align(const std::vector<SurfacePoint>& cloud, const Surface& mesh) {
  Pose mesh_from_model = Pose::Identity();
  for (int round = 0; round < kRounds; ++round) {
    SmallMotion motion;
    motion.centre = mesh_from_model.translation();
    for (const SurfacePoint& point : cloud) {
      const Eigen::Vector3d p = mesh_from_model * point.position.cast<double>();
      const Eigen::Vector3d n = mesh_from_model.linear() * point.normal.cast<double>();
      if (const SurfacePoint* pair = mesh.nearestFacing(p.cast<float>(), n.cast<float>())) motion.addPair(p, *pair);
    }
    mesh_from_model = motion.solve() * mesh_from_model;
  }
  return mesh_from_model;
}

// Which of the mesh's points at least one frame of the recording shows.
std::vector<char> seenIn(const std::string& split, const std::vector<SurfacePoint>& points) {
  std::vector<char> seen(points.size(), 0);
  for (const BopFrame& entry : readBopSplit(split)) {
    const RgbdFrame frame = loadBopFrame(entry);
    const cv::Mat depth = depthInMetres(frame.depth);
    const CameraModel camera = frame.depthCamera();
    const Pose pose = entry.ground_truth.at(0).camera_from_object;
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = pose * points[i].position.cast<double>();
      const Eigen::Vector3d n = pose.linear() * points[i].normal.cast<double>();
      if (seen[i] || p.z() <= 0.0 || -n.dot(p.normalized()) < kMinCosine) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
      if (cv::Rect({}, depth.size()).contains(at)) seen[i] = std::abs(depth.at<float>(at) - p.z()) < kSeenDepth;
    }
  }
  return seen;
}

Eigen::Vector3d middleOf(const std::vector<SurfacePoint>& cloud) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const SurfacePoint& point : cloud) middle += point.position.cast<double>() / static_cast<double>(cloud.size());
  return middle;
}

void compare(const ObjectModel& model, TexturedMesh mesh, const std::string& split) {
  mesh.normals.clear();  // its faces': those of its vertices may be smoothed over edges
  const Surface surface(sampleSurface(mesh, kSampleSpacing, kMaxSamples));
  const Pose mesh_from_model = align(model.cloud, surface);
  double squares = 0.0;
  int far = 0;
  Surface cloud({});
  for (SurfacePoint point : model.cloud) {
    point.position = (mesh_from_model * point.position.cast<double>()).cast<float>();
    cloud.grid.insert(point.position, static_cast<int>(cloud.points.size()));
    cloud.points.push_back(point);
    const SurfacePoint* pair = surface.nearest(point.position);
    far += pair == nullptr;
    const float distance = pair ? pair->normal.dot(point.position - pair->position) : kReach;
    squares += static_cast<double>(distance * distance);
  }
  const std::vector<char> seen = seenIn(split, surface.points);
  int visible = 0, covered = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    ++visible;
    const SurfacePoint* pair = cloud.nearest(surface.points[i].position);
    covered += pair != nullptr && (pair->position - surface.points[i].position).norm() < kCovered;
  }
  const Extents truth = computeExtents(sampleSurface(mesh, 0.003, 30000));
  const auto ratio = [](double is, double should) { return 100.0 * (is / should - 1.0); };
  const Eigen::Vector3d middle = middleOf(model.cloud);
  std::printf("%s,%zu,%.2f,%d,%.1f,%.1f,%.1f,%.1f,%.1f,%.2f\n", model.name.c_str(), model.cloud.size(),
              1000.0 * std::sqrt(squares / static_cast<double>(model.cloud.size())), far,
              visible > 0 ? 100.0 * covered / visible : 0.0, ratio(model.extents.sigma_min, truth.sigma_min),
              ratio(model.extents.sigma_max, truth.sigma_max), ratio(model.extents.sigma_d, truth.sigma_d),
              1000.0 * (mesh_from_model * middle - middle).norm(),
              Eigen::AngleAxisd(mesh_from_model.linear()).angle() * 180.0 / M_PI);
}

int main(int argc, char** argv) {
  std::string store, name, mesh, split;
  double unit = 0.001;
  CLI::App app(
      "A model trained from a recording of `simulate turntable`, with --board-from-object, against its mesh, as one "
      "line of CSV: name, points, RMS of the cloud from the mesh (mm), points farther than 12 mm, share of what the "
      "camera saw that is covered (%), deviations of sigma_min, sigma_max, sigma_d (%), offset (mm) and turn (degrees) "
      "that fit the model to the mesh best.");
  app.add_option("--models", store, "model store")->required()->check(CLI::ExistingDirectory);
  app.add_option("--name", name, "model")->required();
  app.add_option("--mesh", mesh, "mesh that was recorded")->required()->check(CLI::ExistingFile);
  app.add_option("--unit", unit, "length of its unit, metres")->capture_default_str();
  app.add_option("--frames", split, "the recording, a BOP split with ground truth")
      ->required()
      ->check(CLI::ExistingDirectory);
  try {
    app.parse(argc, argv);
    compare(ModelStore(store).load(name), readMesh(mesh, unit), split);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_training: %s\n", error.what());
    return 1;
  }
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) { return recognition::main(argc, argv); }
