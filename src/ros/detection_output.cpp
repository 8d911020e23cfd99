#include "ros/detection_output.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <initializer_list>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <boost/make_shared.hpp>

#include "rgbd_recognition/annotation.h"
#include "ros/message_conversions.h"
#include "search/frame_search.h"

namespace recognition {
namespace {

using visualization_msgs::Marker;

constexpr size_t kMaxPoints = 4000;    // of a model's cloud in rviz
constexpr size_t kMaxRejected = 5;     // more hide each other
constexpr float kOffSurface = 0.004f;  // metres that a model's points are drawn before the scene's, not to mix
constexpr double kText = 0.024, kSmallText = 0.018;  // heights of capitals at most, metres

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
  const size_t stride = std::max<size_t>(1, (model.cloud.size() + kMaxPoints - 1) / kMaxPoints);
  for (size_t i = 0; i < model.cloud.size(); i += stride) {
    const SurfacePoint& point = model.cloud[i];
    geometry_msgs::Point position;
    const Eigen::Vector3f off = point.position + kOffSurface * point.normal;
    position.x = off.x(), position.y = off.y(), position.z = off.z();
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

bool hasBox(const messages::Detection& detection) { return detection.box.orientation != geometry_msgs::Quaternion(); }

std::string nameWithConfidence(const messages::Detection& detection) {
  return recognition::nameWithConfidence(detection.object, detection.confidence);
}

Marker labelMarker(const std::string& text, const LabelPlace& place) {
  Marker marker;
  marker.ns = "label";
  marker.type = Marker::TEXT_VIEW_FACING;
  marker.text = text;
  marker.pose.position.x = place.center.x(), marker.pose.position.y = place.center.y();
  marker.pose.position.z = place.center.z();
  marker.pose.orientation.w = 1.0;
  marker.scale.z = place.size;
  return marker;
}

/// An empty one that removes what the last frame's held.
visualization_msgs::MarkerArrayPtr newMarkers(const std_msgs::Header& header) {
  const auto array = boost::make_shared<visualization_msgs::MarkerArray>();
  array->markers.emplace_back();
  array->markers.back().action = Marker::DELETEALL;
  array->markers.back().header = header;
  return array;
}

/// Adds the markers of one object, with one id.
void append(std::initializer_list<Marker> markers, visualization_msgs::MarkerArray* array) {
  const int id = static_cast<int>(array->markers.size());
  for (const Marker& marker : markers) {
    array->markers.push_back(marker);
    array->markers.back().header = array->markers.front().header;
    array->markers.back().id = id;
  }
}

}  // namespace

std::string inWords(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string frameName(const messages::Detection& detection, const std::string& prefix) {
  return prefix + detection.object + "_" + std::to_string(detection.instance);
}

void nameFrames(const std::string& prefix, messages::DetectionArray* detections) {
  for (messages::Detection& detection : detections->detections)
    if (detection.accepted) detection.frame = frameName(detection, prefix);
}

void changeFrame(const Pose& target_from_header, const std::string& target, messages::DetectionArray* detections) {
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = target_from_header.linear();
  for (messages::Detection& detection : detections->detections) {
    detection.pose.pose = poseMessage(target_from_header * poseFromMessage(detection.pose.pose));
    if (hasBox(detection)) detection.box = poseMessage(target_from_header * poseFromMessage(detection.box));
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(detection.pose.covariance.data());
    covariance = (turn * covariance * turn.transpose()).eval();
  }
  detections->header.frame_id = target;
}

tf2_msgs::TFMessagePtr transformsOf(const messages::DetectionArray& detections) {
  const auto message = boost::make_shared<tf2_msgs::TFMessage>();
  for (const messages::Detection& detection : detections.detections)
    if (!detection.frame.empty())
      message->transforms.push_back(transformMessage(detection.pose.pose, detections.header, detection.frame));
  return message;
}

const MarkerMaker::Prepared& MarkerMaker::prepared(const ObjectModel& model, int object) {
  const auto found = prepared_.find(&model);
  if (found != prepared_.end()) return found->second;
  return prepared_[&model] = {cloudMarker(model), ellipsoidMarker(model, object), boxAround(model.cloud)};
}

std::vector<MarkerMaker::Placed> MarkerMaker::place(const std::vector<const messages::Detection*>& detections,
                                                    const std::vector<std::string>& labels, double max_size,
                                                    const ModelDatabase& database, LabelLayout* layout) {
  std::vector<Placed> all;
  for (size_t i = 0; i < detections.size(); ++i) {
    const int object = database.find(detections[i]->object);
    if (object < 0) continue;
    Placed placed;
    placed.prepared = &prepared(*database.objects[static_cast<size_t>(object)], object);
    placed.frame_from_object = poseFromMessage(detections[i]->pose.pose);
    placed.frame_from_ellipsoid = placed.frame_from_object * poseFromMessage(placed.prepared->ellipsoid.pose);
    placed.label = labels[i];
    placed.number = layout->addObject(placed.prepared->box, placed.frame_from_object);
    all.push_back(placed);
  }
  for (Placed& placed : all) placed.label_place = layout->place(placed.number, placed.label, max_size);
  return all;
}

visualization_msgs::MarkerArrayPtr MarkerMaker::make(const messages::DetectionArray& detections,
                                                     const ModelDatabase& database, const LabelView& view) {
  const auto array = newMarkers(detections.header);
  LabelLayout layout(view);
  std::vector<const messages::Detection*> found;
  std::vector<std::string> names;
  for (const messages::Detection& detection : detections.detections) {
    found.push_back(&detection);
    names.push_back(nameWithConfidence(detection));
  }
  for (const Placed& placed : place(found, names, kText, database, &layout)) {
    Marker cloud = placed.prepared->cloud, ellipsoid = placed.prepared->ellipsoid;
    cloud.pose = poseMessage(placed.frame_from_object);
    ellipsoid.pose = poseMessage(placed.frame_from_ellipsoid);
    Marker text = labelMarker(placed.label, placed.label_place);
    text.color = color<std_msgs::ColorRGBA>(255, 110, 0, 1.0);  // seen on white tables and on rviz's dark ground
    append({cloud, ellipsoid, text}, array.get());
  }
  return array;
}

visualization_msgs::MarkerArrayPtr MarkerMaker::makeRejected(const messages::DetectionArray& hypotheses,
                                                             const ModelDatabase& database, const LabelView& view) {
  std::vector<const messages::Detection*> accepted, rejected;
  std::vector<std::string> names, reasons;
  for (const messages::Detection& hypothesis : hypotheses.detections) {
    if (hypothesis.accepted)
      accepted.push_back(&hypothesis), names.push_back(nameWithConfidence(hypothesis));
    else if (hypothesis.rejection != rejectionName(Rejection::kDuplicate) &&
             hypothesis.rejection != rejectionName(Rejection::kExplained))
      rejected.push_back(&hypothesis);
  }
  std::stable_sort(rejected.begin(), rejected.end(),
                   [](const auto* a, const auto* b) { return a->confidence > b->confidence; });
  std::set<std::string> shown;  // the best of each object: of most the others are chance
  const auto again = [&shown](const auto* hypothesis) { return !shown.insert(hypothesis->object).second; };
  rejected.erase(std::remove_if(rejected.begin(), rejected.end(), again), rejected.end());
  rejected.resize(std::min(rejected.size(), kMaxRejected));
  for (const messages::Detection* hypothesis : rejected) {
    reasons.push_back(nameWithConfidence(*hypothesis) + ": " + inWords(hypothesis->rejection));
    if (!hypothesis->conflict_with.empty()) reasons.back() += " with " + hypothesis->conflict_with;
  }

  const auto array = newMarkers(hypotheses.header);
  LabelLayout layout(view);
  place(accepted, names, kText, database, &layout);
  for (const Placed& placed : place(rejected, reasons, kSmallText, database, &layout)) {
    Marker ellipsoid = placed.prepared->ellipsoid;
    ellipsoid.pose = poseMessage(placed.frame_from_ellipsoid);
    ellipsoid.color = color<std_msgs::ColorRGBA>(255, 60, 60, 0.15);
    Marker text = labelMarker(placed.label, placed.label_place);
    text.color = color<std_msgs::ColorRGBA>(255, 50, 70, 1.0);
    append({ellipsoid, text}, array.get());
  }
  return array;
}

}  // namespace recognition
