#include "rgbd_recognition/ros/detection_output.h"

#include <algorithm>
#include <cstdio>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <boost/make_shared.hpp>

#include "rgbd_recognition/annotation.h"
#include "rgbd_recognition/ros/message_conversions.h"

namespace rgbd_recognition {
namespace {

using visualization_msgs::Marker;

constexpr size_t kMostPoints = 4000;  // of a model's cloud in rviz
constexpr size_t kMostRejected = 5;   // more hide each other
constexpr double kSmallText = 0.018;  // metres

template <typename Color>
Color color(double r, double g, double b, double a) {
  Color c;
  c.r = static_cast<float>(r / 255.0), c.g = static_cast<float>(g / 255.0), c.b = static_cast<float>(b / 255.0),
  c.a = static_cast<float>(a);
  return c;
}

Marker cloudMarker(const ObjectModel& model) {
  Marker marker;
  marker.ns = "cloud";
  marker.type = Marker::POINTS;
  marker.scale.x = marker.scale.y = 0.003;
  marker.color.a = 1.0f;
  const size_t stride = std::max<size_t>(1, model.cloud.size() / kMostPoints);
  for (size_t i = 0; i < model.cloud.size(); i += stride) {
    const SurfacePoint& point = model.cloud[i];
    geometry_msgs::Point position;
    position.x = point.position.x(), position.y = point.position.y(), position.z = point.position.z();
    marker.points.push_back(position);
    marker.colors.push_back(color<std_msgs::ColorRGBA>(point.rgb[0], point.rgb[1], point.rgb[2], 1.0));
  }
  return marker;
}

/// The ellipsoid behind Sigma, eq. (4): axes and three standard deviations of the cloud.
Marker ellipsoidMarker(const ObjectModel& model, int object) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const SurfacePoint& point : model.cloud) {
    const Eigen::Vector3d p = point.position.cast<double>();
    mean += p;
    square += p * p.transpose();
  }
  const double n = std::max<double>(1.0, static_cast<double>(model.cloud.size()));
  mean /= n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pca(square / n - mean * mean.transpose());
  Pose object_from_ellipsoid = Pose::Identity();
  object_from_ellipsoid.linear() = pca.eigenvectors();
  if (pca.eigenvectors().determinant() < 0.0) object_from_ellipsoid.linear().col(0) *= -1.0;
  object_from_ellipsoid.translation() = mean;
  const Eigen::Vector3d diameters = 6.0 * pca.eigenvalues().cwiseMax(1e-8).cwiseSqrt();
  const cv::Scalar bgr = objectColor(object);

  Marker marker;
  marker.ns = "ellipsoid";
  marker.type = Marker::SPHERE;
  marker.pose = poseMessage(object_from_ellipsoid);
  marker.scale.x = diameters.x(), marker.scale.y = diameters.y(), marker.scale.z = diameters.z();
  marker.color = color<std_msgs::ColorRGBA>(bgr[2], bgr[1], bgr[0], 0.25);
  return marker;
}

std::string nameWithConfidence(const messages::Detection& detection) {
  char confidence[16];
  std::snprintf(confidence, sizeof(confidence), " %.2f", detection.confidence);
  return detection.object + confidence;
}

/// too_little_seen -> too little seen.
std::string inWords(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Marker labelMarker(const geometry_msgs::Pose& pose, const std::string& text, const Eigen::Vector3d& shift) {
  Marker marker;
  marker.ns = "label";
  marker.type = Marker::TEXT_VIEW_FACING;
  marker.text = text;
  marker.pose = pose;
  marker.pose.position.x += shift.x(), marker.pose.position.y += shift.y(), marker.pose.position.z += shift.z();
  marker.scale.z = 0.03;
  marker.color = color<std_msgs::ColorRGBA>(255, 110, 0, 1.0);  // seen on white tables and on rviz's dark ground
  return marker;
}

}  // namespace

std::string frameName(const messages::Detection& detection) {
  return detection.object + "_" + std::to_string(detection.instance);
}

void changeFrame(const Pose& target_from_header, const std::string& target, messages::DetectionArray* detections) {
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = target_from_header.linear();
  for (messages::Detection& detection : detections->detections) {
    detection.pose.pose = poseMessage(target_from_header * poseFromMessage(detection.pose.pose));
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(detection.pose.covariance.data());
    covariance = (turn * covariance * turn.transpose()).eval();
  }
  detections->header.frame_id = target;
}

tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections) {
  const auto message = boost::make_shared<tf2_msgs::TFMessage>();
  for (const messages::Detection& detection : detections.detections) {
    geometry_msgs::TransformStamped transform;
    transform.header = detections.header;
    transform.child_frame_id = frameName(detection);
    const geometry_msgs::Pose& pose = detection.pose.pose;
    transform.transform.translation.x = pose.position.x;
    transform.transform.translation.y = pose.position.y;
    transform.transform.translation.z = pose.position.z;
    transform.transform.rotation = pose.orientation;
    message->transforms.push_back(transform);
  }
  return message;
}

const MarkerMaker::Prepared& MarkerMaker::prepared(const ObjectModel& model, int object) {
  const auto found = prepared_.find(&model);
  if (found != prepared_.end()) return found->second;
  return prepared_[&model] = {cloudMarker(model), ellipsoidMarker(model, object), 0.5 * model.extents.sigma_max + 0.03};
}

visualization_msgs::MarkerArrayPtr MarkerMaker::make(const messages::DetectionArray& detections,
                                                     const ModelDatabase& database, const Eigen::Vector3d& up) {
  const auto array = boost::make_shared<visualization_msgs::MarkerArray>();
  array->markers.emplace_back();
  array->markers.back().action = Marker::DELETEALL;
  array->markers.back().header = detections.header;
  for (const messages::Detection& detection : detections.detections)
    add(detection, nameWithConfidence(detection), true, up, database, array.get());
  return array;
}

visualization_msgs::MarkerArrayPtr MarkerMaker::makeRejected(const messages::DetectionArray& hypotheses,
                                                             const ModelDatabase& database, const Eigen::Vector3d& up) {
  std::vector<const messages::Detection*> rejected;
  for (const messages::Detection& hypothesis : hypotheses.detections)
    if (!hypothesis.accepted) rejected.push_back(&hypothesis);
  std::stable_sort(rejected.begin(), rejected.end(),
                   [](const auto* a, const auto* b) { return a->confidence > b->confidence; });
  rejected.resize(std::min(rejected.size(), kMostRejected));

  const auto array = boost::make_shared<visualization_msgs::MarkerArray>();
  array->markers.emplace_back();
  array->markers.back().action = Marker::DELETEALL;
  array->markers.back().header = hypotheses.header;
  double row = 0.0;  // labels of one place above each other
  for (const messages::Detection* hypothesis : rejected) {
    std::string why = nameWithConfidence(*hypothesis) + ": " + inWords(hypothesis->rejection);
    if (!hypothesis->conflict_with.empty()) why += " with " + hypothesis->conflict_with;
    add(*hypothesis, why, false, (1.0 + row) * up, database, array.get());
    row += 0.2;
  }
  return array;
}

void MarkerMaker::add(const messages::Detection& detection, const std::string& label, bool accepted,
                      const Eigen::Vector3d& up, const ModelDatabase& database,
                      visualization_msgs::MarkerArray* array) {
  const int object = database.find(detection.object);
  if (object < 0) return;
  const size_t first = array->markers.size();
  const Prepared& drawn = prepared(*database.objects[static_cast<size_t>(object)], object);
  Marker ellipsoid = drawn.ellipsoid;
  ellipsoid.pose = poseMessage(poseFromMessage(detection.pose.pose) * poseFromMessage(drawn.ellipsoid.pose));
  Marker text = labelMarker(detection.pose.pose, label, drawn.height * up);
  if (accepted) {
    array->markers.push_back(drawn.cloud);
    array->markers.back().pose = detection.pose.pose;
  } else {
    ellipsoid.color = color<std_msgs::ColorRGBA>(255, 60, 60, 0.15);
    text.color = color<std_msgs::ColorRGBA>(220, 0, 60, 1.0);
    text.scale.z = kSmallText;
  }
  array->markers.insert(array->markers.end(), {ellipsoid, text});
  for (size_t i = first; i < array->markers.size(); ++i) {
    array->markers[i].header = array->markers.front().header;
    array->markers[i].id = static_cast<int>(first);
  }
}

}  // namespace rgbd_recognition
