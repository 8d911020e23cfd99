#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/core/camera.h"
#include "ros/object_shape.h"

namespace recognition {

/// Somebody who looks at labels, in the detections' frame. Directions are unit vectors.
struct LabelViewer {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ(), up = -Eigen::Vector3d::UnitY();

  Eigen::Vector3d right() const { return forward.cross(up); }
};

/// For whom labels are placed.
struct LabelView {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  std::vector<LabelViewer> viewers;   ///< the first one is the camera; empty where a viewer may be anywhere
  std::optional<CameraModel> camera;  ///< whose picture labels must not leave, if a viewer is there

  /// Of detections in the camera's frame: seen from the camera, and from above it as rviz/recognition.rviz shows them.
  static LabelView ofCamera(const std::optional<CameraModel>& camera = std::nullopt);
};

/// A text's middle, and the height of its capitals, in metres.
struct LabelPlace {
  Eigen::Vector3d center;
  double size;
};

/// Keeps labels readable: in the picture, clear of each other and of other objects, and close to their own, as each
/// viewer sees them.
class LabelLayout {
 public:
  explicit LabelLayout(const LabelView& view) : view_(view) {}

  /// An object of which labels keep clear. Returns its number for place().
  size_t addObject(const OrientedBox& box, const Pose& frame_from_object);
  /// The best place round the object, above it if that is free, for a text of at most that size. The text is small for a
  /// small object, and smaller where room is scarce.
  LabelPlace place(size_t object, const std::string& text, double max_size);

 private:
  struct Item {
    Eigen::Vector3d center;
    std::vector<Eigen::Vector2d> half;  // width and height for each viewer, metres; without viewers one for all sides
  };
  /// As a viewer sees it: shares of the distance.
  struct Rectangle {
    Eigen::Vector2d middle, half;
    double shareUnder(const Rectangle& other) const;  // of its area
    double distanceTo(const Rectangle& other) const;  // zero if they touch
  };
  Item labelItem(const std::string& text, double size) const;
  Rectangle rectangleOf(const Item& item, size_t viewer) const;
  std::vector<Eigen::Vector3d> placesRound(const Item& object, const Item& label) const;
  /// How bad that place is for a label of the object: by what it covers, and how far it is away.
  double cost(const Item& label, size_t object) const;
  double shareOutsidePicture(const Item& label) const;
  LabelPlace placeForViewers(size_t object, const std::string& text, double max_size);
  LabelPlace placeForAll(const Item& object, const std::string& text, double size);

  LabelView view_;
  std::vector<Item> objects_, labels_;
};

}  // namespace recognition
