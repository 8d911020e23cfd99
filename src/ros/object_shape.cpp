#include "ros/object_shape.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

#include <opencv2/imgproc.hpp>

#include "ros/message_conversions.h"

namespace recognition {
namespace {

constexpr double kAsGood = 1.02;     // of two volumes
constexpr size_t kMaxModels = 1000;  // earlier stores' included

double volume(const OrientedBox& box) { return box.size.prod(); }

OrientedBox alongAxes(const std::vector<SurfacePoint>& cloud) {
  Eigen::Vector3f low = cloud.front().position, high = low;
  for (const SurfacePoint& point : cloud) {
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  OrientedBox box;
  box.object_from_box.translation() = (0.5f * (low + high)).cast<double>();
  box.size = (high - low).cast<double>();
  return box;
}

/// One edge along the object's axis `axis`, as long as that of `straight`; around it as small as it gets.
OrientedBox aroundAxis(const std::vector<SurfacePoint>& cloud, int axis, const OrientedBox& straight) {
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  std::vector<cv::Point2f> flat;
  for (const SurfacePoint& point : cloud) flat.emplace_back(point.position[first], point.position[second]);
  const cv::RotatedRect rectangle = cv::minAreaRect(flat);
  const double angle = rectangle.angle * CV_PI / 180.0;
  OrientedBox box = straight;
  box.object_from_box.translation()[first] = rectangle.center.x;
  box.object_from_box.translation()[second] = rectangle.center.y;
  box.object_from_box.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
  box.size[first] = rectangle.size.width;
  box.size[second] = rectangle.size.height;
  return box;
}

constexpr char kMeshUnit[] = "mesh_unit";  // in the provenance of models trained from meshes, metres

}  // namespace

OrientedBox boxAround(const std::vector<SurfacePoint>& cloud) {
  if (cloud.empty()) return {};
  const OrientedBox straight = alongAxes(cloud);
  OrientedBox best = straight;
  for (int axis = 0; axis < 3; ++axis) {
    const OrientedBox box = aroundAxis(cloud, axis, straight);
    if (volume(box) < volume(best)) best = box;
  }
  return volume(straight) < kAsGood * volume(best) ? straight : best;
}

std::string meshUri(const ObjectModel& model) {
  std::error_code error;
  const std::filesystem::path file(model.source);
  const bool there =
      model.provenance.count(kMeshUnit) > 0 && file.is_absolute() && std::filesystem::is_regular_file(file, error);
  return there ? "file://" + model.source : "";
}

const ObjectShapes::Shape& ObjectShapes::of(const std::shared_ptr<const ObjectModel>& model) {
  if (shapes_.size() > kMaxModels) shapes_.clear();
  const auto found = shapes_.find(model);
  if (found != shapes_.end()) return found->second;
  Shape shape{boxAround(model->cloud), meshUri(*model), 0.0};
  if (!shape.mesh.empty()) shape.mesh_scale = std::strtod(model->provenance.at(kMeshUnit).c_str(), nullptr);
  return shapes_[model] = shape;
}

void ObjectShapes::fillIn(const ModelDatabase& database, messages::DetectionArray* detections) {
  for (messages::Detection& detection : detections->detections) {
    const int object = database.find(detection.object);
    if (object < 0) continue;
    const Shape& shape = of(database.objects[static_cast<size_t>(object)]);
    detection.box = poseMessage(poseFromMessage(detection.pose.pose) * shape.box.object_from_box);
    detection.size.x = shape.box.size.x(), detection.size.y = shape.box.size.y(), detection.size.z = shape.box.size.z();
    detection.mesh = shape.mesh;
    detection.mesh_scale = shape.mesh_scale;
  }
}

}  // namespace recognition
