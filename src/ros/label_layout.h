#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/core/camera.h"
#include "ros/object_shape.h"

namespace recognition {

/// How labels are placed so that they can be read: unit vectors in the detections' frame.
struct LabelView {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  ///< the viewer; zero where he may be anywhere
  std::optional<CameraModel> camera;                  ///< whose picture labels must not leave, if the viewer is there

  static LabelView ofCamera(const std::optional<CameraModel>& camera = std::nullopt) {
    return {-Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ(), camera};
  }
};

/// Keeps labels from covering each other, and, for a viewer at the camera, other objects than their own.
class LabelLayout {
 public:
  explicit LabelLayout(const LabelView& view) : view_(view), right_(view.up.cross(view.towards)) {}

  /// An object; labels of others keep clear of it. Returns its number for place().
  size_t addObject(const OrientedBox& box, const Pose& frame_from_object);
  /// Where a text of that size (metres) goes: above the object, or below or beside it where that is free, or above
  /// whatever labels are in its way.
  Eigen::Vector3d place(size_t object, const std::string& text, double size);

 private:
  struct Item {
    Eigen::Vector3d center;
    double half_width, half_height;  // metres
  };
  /// In the picture, as shares of the distance; where there is no picture, in metres.
  struct Rectangle {
    double x, y, half_width, half_height;
  };
  bool isSeenFromCamera() const { return !view_.towards.isZero(); }
  Rectangle rectangleOf(const Item& item) const;
  bool cover(const Item& a, const Item& b) const;
  bool isFree(const Item& label, size_t own_object) const;
  bool isInPicture(const Item& label) const;
  Eigen::Vector3d aboveLabels(Item label);

  LabelView view_;
  Eigen::Vector3d right_;
  std::vector<Item> objects_, labels_;
};

}  // namespace recognition
