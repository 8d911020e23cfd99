#include "ros/label_layout.h"

#include <algorithm>
#include <cmath>

namespace recognition {
namespace {

constexpr double kWidthOfText = 0.65;  // of a character, in heights
constexpr double kLine = 1.6;          // heights
constexpr double kGap = 0.01;          // metres between object and label
constexpr double kNearer = 0.1;        // metres that labels lie before their objects, which else hide them
constexpr double kNearest = 0.05;      // metres from the camera

double halfExtent(const OrientedBox& box, const Eigen::Matrix3d& frame_from_box, const Eigen::Vector3d& direction) {
  return 0.5 * (frame_from_box.transpose() * direction).cwiseAbs().dot(box.size);
}

}  // namespace

size_t LabelLayout::addObject(const OrientedBox& box, const Pose& frame_from_object) {
  const Pose frame_from_box = frame_from_object * box.object_from_box;
  const Eigen::Matrix3d rotation = frame_from_box.linear();
  const double half_width = isSeenFromCamera() ? halfExtent(box, rotation, right_) : 0.5 * box.size.norm();
  objects_.push_back({frame_from_box.translation(), half_width, halfExtent(box, rotation, view_.up)});
  return objects_.size() - 1;
}

LabelLayout::Rectangle LabelLayout::rectangleOf(const Item& item) const {
  const double distance = std::max(kNearest, -view_.towards.dot(item.center));
  return {right_.dot(item.center) / distance, view_.up.dot(item.center) / distance, item.half_width / distance,
          item.half_height / distance};
}

bool LabelLayout::cover(const Item& a, const Item& b) const {
  if (isSeenFromCamera()) {
    const Rectangle p = rectangleOf(a), q = rectangleOf(b);
    return std::abs(p.x - q.x) < p.half_width + q.half_width && std::abs(p.y - q.y) < p.half_height + q.half_height;
  }
  const Eigen::Vector3d apart = a.center - b.center;
  const double above = apart.dot(view_.up), beside = (apart - above * view_.up).norm();
  return beside < a.half_width + b.half_width && std::abs(above) < a.half_height + b.half_height;
}

bool LabelLayout::isInPicture(const Item& label) const {
  if (!view_.camera || !isSeenFromCamera()) return true;
  const Rectangle r = rectangleOf(label);
  const CameraModel& c = *view_.camera;
  const double u = c.fx * r.x + c.cx, v = c.cy - c.fy * r.y;
  return u - c.fx * r.half_width >= 0.0 && u + c.fx * r.half_width < c.width && v - c.fy * r.half_height >= 0.0 &&
         v + c.fy * r.half_height < c.height;
}

bool LabelLayout::isFree(const Item& label, size_t own_object) const {
  for (size_t i = 0; i < objects_.size(); ++i)
    if (i != own_object && cover(label, objects_[i])) return false;
  return isInPicture(label) &&
         std::none_of(labels_.begin(), labels_.end(), [&](const Item& other) { return cover(label, other); });
}

Eigen::Vector3d LabelLayout::aboveLabels(Item label) {
  const auto in_the_way = [&] {
    return std::find_if(labels_.begin(), labels_.end(), [&](const Item& other) { return cover(label, other); });
  };
  for (auto other = in_the_way(); other != labels_.end(); other = in_the_way()) {
    const double above = (label.center - other->center).dot(view_.up);
    label.center += std::max(1e-3, 1.01 * (label.half_height + other->half_height) - above) * view_.up;
  }
  return label.center;
}

Eigen::Vector3d LabelLayout::place(size_t object, const std::string& text, double size) {
  const Item& own = objects_.at(object);
  Item label{own.center + kNearer * view_.towards, 0.5 * kWidthOfText * size * static_cast<double>(text.size()),
             0.5 * kLine * size};
  const Eigen::Vector3d middle = label.center;
  const double up = own.half_height + label.half_height + kGap, right = own.half_width + label.half_width + kGap;
  std::vector<Eigen::Vector3d> places = {middle + up * view_.up};
  if (isSeenFromCamera())
    places.insert(places.end(), {middle - up * view_.up, middle + right * right_, middle - right * right_});
  for (const Eigen::Vector3d& place : places) {
    label.center = place;
    if (!isFree(label, object)) continue;
    labels_.push_back(label);
    return place;
  }
  label.center = places.front();
  label.center = aboveLabels(label);
  labels_.push_back(label);
  return label.center;
}

}  // namespace recognition
