#include "ros/label_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace recognition {
namespace {

constexpr double kWidthOfText = 0.65;  // of a character, in heights
constexpr double kLine = 1.6;          // heights
constexpr double kGap = 0.01;          // metres between object and label
constexpr double kNearer = 0.1;        // metres that labels lie before their objects, which else hide them
constexpr double kNearest = 0.05;      // metres from a viewer
constexpr double kMinSize = 0.012;     // metres, below which nobody can read a text
constexpr double kTextOfObject = 1.6;  // width of a text, in lengths of its object
constexpr double kShrink = 0.8;        // from one size of a text to the next one tried
constexpr int kSteps = 3;              // away from the object, each of a text's height
// Costs of a place. The first four are of a label that is covered, or covers, in whole.
constexpr double kOverLabel = 20.0, kOverObject = 4.0, kOverOwnObject = 0.5, kOutsidePicture = 10.0;
constexpr double kAway = 0.15;  // of each text's height between label and object
constexpr double kNotAbove = 0.3;
constexpr double kNearAnother = 1.0;  // of a label that people would take for another object's
constexpr double kSmaller = 0.2;      // of each step to a smaller text

double halfExtent(const OrientedBox& box, const Eigen::Matrix3d& frame_from_box, const Eigen::Vector3d& direction) {
  return 0.5 * (frame_from_box.transpose() * direction).cwiseAbs().dot(box.size);
}

}  // namespace

LabelView LabelView::ofCamera(const std::optional<CameraModel>& camera) {
  LabelViewer above;  // as rviz/recognition.rviz: 0.8 m from (0, -0.02, 1), looking down by 0.32 rad
  above.eye = {0.0, -0.27, 0.24};
  above.forward = Eigen::Vector3d(0.0, 0.25, 0.76).normalized();
  above.up = Eigen::Vector3d(0.0, -0.76, 0.25).normalized();
  return {-Eigen::Vector3d::UnitY(), {LabelViewer(), above}, camera};
}

size_t LabelLayout::addObject(const OrientedBox& box, const Pose& frame_from_object) {
  const Pose frame_from_box = frame_from_object * box.object_from_box;
  Item item{frame_from_box.translation(), {}};
  const auto extent = [&](const Eigen::Vector3d& direction) {
    return halfExtent(box, frame_from_box.linear(), direction);
  };
  for (const LabelViewer& viewer : view_.viewers) item.half.emplace_back(extent(viewer.right()), extent(viewer.up));
  if (view_.viewers.empty()) item.half.emplace_back(0.5 * box.size.norm(), extent(view_.up));
  objects_.push_back(item);
  return objects_.size() - 1;
}

double LabelLayout::Rectangle::shareUnder(const Rectangle& other) const {
  const Eigen::Vector2d common =
      (middle + half).cwiseMin(other.middle + other.half) - (middle - half).cwiseMax(other.middle - other.half);
  return common.cwiseMax(0.0).prod() / (4.0 * half.prod());
}

double LabelLayout::Rectangle::distanceTo(const Rectangle& other) const {
  return ((middle - other.middle).cwiseAbs() - half - other.half).cwiseMax(0.0).norm();
}

LabelLayout::Item LabelLayout::labelItem(const std::string& text, double size) const {
  const Eigen::Vector2d half(0.5 * kWidthOfText * size * static_cast<double>(text.size()), 0.5 * kLine * size);
  return {Eigen::Vector3d::Zero(), std::vector<Eigen::Vector2d>(std::max<size_t>(1, view_.viewers.size()), half)};
}

LabelLayout::Rectangle LabelLayout::rectangleOf(const Item& item, size_t viewer) const {
  const LabelViewer& v = view_.viewers[viewer];
  const Eigen::Vector3d ray = item.center - v.eye;
  const double distance = std::max(kNearest, ray.dot(v.forward));
  return {Eigen::Vector2d(ray.dot(v.right()), ray.dot(v.up)) / distance, item.half[viewer] / distance};
}

double LabelLayout::shareOutsidePicture(const Item& label) const {
  if (!view_.camera) return 0.0;
  const CameraModel& c = *view_.camera;
  const Eigen::Vector2d min(-c.cx / c.fx, (c.cy - c.height) / c.fy), max((c.width - c.cx) / c.fx, c.cy / c.fy);
  return 1.0 - rectangleOf(label, 0).shareUnder({0.5 * (min + max), 0.5 * (max - min)});
}

double LabelLayout::cost(const Item& label, size_t object) const {
  double sum = 0.0;
  for (size_t viewer = 0; viewer < view_.viewers.size(); ++viewer) {
    const Rectangle own = rectangleOf(label, viewer);
    const double height = 2.0 * own.half.y();
    std::vector<double> away;
    for (size_t i = 0; i < objects_.size(); ++i) {
      const Rectangle other = rectangleOf(objects_[i], viewer);
      sum += (i == object ? kOverOwnObject : kOverObject) * own.shareUnder(other);
      away.push_back(own.distanceTo(other));
    }
    for (const Item& other : labels_) sum += kOverLabel * own.shareUnder(rectangleOf(other, viewer));
    sum += kAway * away[object] / height;
    if (*std::min_element(away.begin(), away.end()) < away[object]) sum += kNearAnother;
  }
  return sum + kOutsidePicture * shareOutsidePicture(label);
}

std::vector<Eigen::Vector3d> LabelLayout::placesRound(const Item& object, const Item& label) const {
  const LabelViewer& camera = view_.viewers.front();
  const Eigen::Vector3d ray = object.center - camera.eye;
  const Eigen::Vector3d nearer = object.center - std::min(kNearer, 0.5 * ray.norm()) * ray.normalized();
  const double up = object.half[0].y() + label.half[0].y() + kGap;
  const double right = object.half[0].x() + label.half[0].x() + kGap;
  const double shifted = object.half[0].x();
  std::vector<Eigen::Vector3d> places;
  for (int step = 0; step < kSteps; ++step) {
    const double y = up + 2.0 * step * label.half[0].y();
    for (const double x : {0.0, shifted, -shifted}) places.push_back(nearer + y * camera.up + x * camera.right());
    for (const double x : {0.0, shifted, -shifted}) places.push_back(nearer - y * camera.up + x * camera.right());
  }
  for (const double x : {right, -right, shifted, -shifted, 0.0})
    for (const double share : {0.0, 0.4, -0.4, 0.8, -0.8})
      places.push_back(nearer + share * up * camera.up + x * camera.right());
  return places;
}

LabelPlace LabelLayout::placeForViewers(size_t object, const std::string& text, double max_size) {
  double least = std::numeric_limits<double>::max(), smaller = 0.0;
  Item best;
  LabelPlace place{objects_[object].center, max_size};
  for (double size = max_size;; size = std::max(kMinSize, kShrink * size), smaller += kSmaller) {
    Item label = labelItem(text, size);
    const std::vector<Eigen::Vector3d> places = placesRound(objects_[object], label);
    for (const Eigen::Vector3d& center : places) {
      label.center = center;
      const bool is_above = center == places.front();
      const double cost_here = smaller + (is_above ? 0.0 : kNotAbove) + cost(label, object);
      if (cost_here < least) least = cost_here, best = label, place = {center, size};
    }
    if (size <= kMinSize) break;
  }
  labels_.push_back(best);
  return place;
}

LabelPlace LabelLayout::placeForAll(const Item& object, const std::string& text, double size) {
  Item label = labelItem(text, size);
  label.center = object.center + (object.half[0].y() + label.half[0].y() + kGap) * view_.up;
  const auto covers = [&](const Item& other) {
    const Eigen::Vector3d apart = label.center - other.center;
    const double above = apart.dot(view_.up), beside = (apart - above * view_.up).norm();
    const Eigen::Vector2d reach = label.half[0] + other.half[0];
    return beside < reach.x() && std::abs(above) < reach.y();
  };
  for (auto other = labels_.begin(); other != labels_.end();) {
    if (covers(*other)) {
      const double above = (label.center - other->center).dot(view_.up);
      label.center += std::max(1e-3, 1.01 * (label.half[0].y() + other->half[0].y()) - above) * view_.up;
      other = labels_.begin();
    } else {
      ++other;
    }
  }
  labels_.push_back(label);
  return {label.center, size};
}

LabelPlace LabelLayout::place(size_t object, const std::string& text, double max_size) {
  const Item& own = objects_.at(object);
  const double length = 2.0 * own.half[0].maxCoeff();
  const double fitting =
      kTextOfObject * length / (kWidthOfText * static_cast<double>(std::max<size_t>(1, text.size())));
  const double size = std::clamp(fitting, std::min(kMinSize, max_size), max_size);
  return view_.viewers.empty() ? placeForAll(own, text, size) : placeForViewers(object, text, size);
}

}  // namespace recognition
