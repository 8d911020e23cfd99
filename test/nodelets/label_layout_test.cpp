#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "ros/label_layout.h"

namespace recognition {
namespace {

const CameraModel kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};

struct Thing {
  std::string label;
  OrientedBox box;
  Pose camera_from_object;
};

Thing thing(const std::string& label, const Eigen::Vector3d& size, const Eigen::Vector3d& place) {
  Thing result{label, {}, Pose::Identity()};
  result.box.size = size;
  result.camera_from_object.linear() = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()).toRotationMatrix();
  result.camera_from_object.translation() = place;
  return result;
}

/// Of corners in the viewer's frame (x right, y up, z forward), in shares of the distance.
cv::Rect2d around(const std::vector<Eigen::Vector3d>& corners) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector3d& p : corners)
    points.emplace_back(static_cast<float>(p.x() / p.z()), static_cast<float>(p.y() / p.z()));
  cv::Point2d min = points[0], max = points[0];
  for (const cv::Point2f& p : points) {
    min = {std::min<double>(min.x, p.x), std::min<double>(min.y, p.y)};
    max = {std::max<double>(max.x, p.x), std::max<double>(max.y, p.y)};
  }
  return {min, max};
}

Eigen::Vector3d seenBy(const LabelViewer& viewer, const Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = point - viewer.eye;
  return {ray.dot(viewer.right()), ray.dot(viewer.up), ray.dot(viewer.forward)};
}

cv::Rect2d objectSeenBy(const LabelViewer& viewer, const Thing& object) {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    corners.push_back(
        seenBy(viewer, object.camera_from_object * object.box.object_from_box * corner.cwiseProduct(object.box.size)));
  }
  return around(corners);
}

/// A text of letters that are at least half as wide as they are high.
cv::Rect2d labelSeenBy(const LabelViewer& viewer, const Thing& object, const LabelPlace& place) {
  const Eigen::Vector3d middle = seenBy(viewer, place.center);
  const double half_width = 0.25 * place.size * static_cast<double>(object.label.size());
  return around({middle + Eigen::Vector3d(half_width, 0.5 * place.size, 0.0),
                 middle - Eigen::Vector3d(half_width, 0.5 * place.size, 0.0)});
}

std::vector<LabelPlace> placesOf(const std::vector<Thing>& things, const LabelView& view) {
  LabelLayout layout(view);
  for (const Thing& object : things) layout.addObject(object.box, object.camera_from_object);
  std::vector<LabelPlace> places;
  for (size_t i = 0; i < things.size(); ++i) places.push_back(layout.place(i, things[i].label, 0.024));
  return places;
}

void expectReadable(const std::vector<Thing>& things, const LabelView& view) {
  const std::vector<LabelPlace> places = placesOf(things, view);
  for (size_t viewer = 0; viewer < view.viewers.size(); ++viewer)
    for (size_t i = 0; i < things.size(); ++i) {
      SCOPED_TRACE(things[i].label + ", viewer " + std::to_string(viewer));
      const cv::Rect2d label = labelSeenBy(view.viewers[viewer], things[i], places[i]);
      for (size_t j = 0; j < things.size(); ++j)
        EXPECT_TRUE(i == j || (label & objectSeenBy(view.viewers[viewer], things[j])).empty())
            << "covers " << things[j].label;
      for (size_t j = 0; j < i; ++j)
        EXPECT_TRUE((label & labelSeenBy(view.viewers[viewer], things[j], places[j])).empty())
            << "covers the label of " << things[j].label;
    }
  for (size_t i = 0; i < things.size(); ++i) {
    EXPECT_GE(places[i].size, 0.012) << things[i].label;
    const double half_width = 0.25 * places[i].size * static_cast<double>(things[i].label.size());
    for (const double x : {-half_width, half_width}) {
      const Eigen::Vector2d m = kCamera.project(places[i].center + Eigen::Vector3d(x, 0.0, 0.0));
      EXPECT_TRUE(m.x() > 0.0 && m.x() < kCamera.width && m.y() > 0.0 && m.y() < kCamera.height)
          << things[i].label << " at " << m.transpose();
    }
  }
}

TEST(LabelLayout, keepsClearOfObjectsThatStandBehindForEveryViewer) {
  expectReadable({thing("003_cracker_box 1.00", {0.16, 0.21, 0.07}, {-0.1, -0.08, 1.05}),
                  thing("002_master_chef_can 0.99", {0.1, 0.14, 0.1}, {-0.06, 0.12, 0.95}),
                  thing("004_sugar_box 0.99", {0.05, 0.17, 0.09}, {0.2, 0.1, 0.95}),
                  thing("006_mustard_bottle 0.97", {0.06, 0.19, 0.1}, {0.22, -0.09, 1.05})},
                 LabelView::ofCamera(kCamera));
}

TEST(LabelLayout, keepsLabelsInThePicture) {
  std::vector<Thing> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.38, 0.38}) corners.push_back(thing("chips_can 0.98", {0.08, 0.1, 0.08}, {x, y, 1.0}));
  expectReadable(corners, LabelView::ofCamera(kCamera));
}

TEST(LabelLayout, staysCloserToItsOwnObjectThanToOthers) {
  const std::vector<Thing> things = {thing("002_master_chef_can 0.99", {0.1, 0.14, 0.1}, {-0.06, 0.3, 0.95}),
                                     thing("004_sugar_box 0.99", {0.05, 0.17, 0.09}, {0.1, 0.28, 0.95}),
                                     thing("003_cracker_box 1.00", {0.16, 0.21, 0.07}, {-0.1, 0.08, 1.05})};
  const std::vector<LabelPlace> places = placesOf(things, LabelView::ofCamera(kCamera));
  const LabelViewer camera;
  for (size_t i = 0; i < things.size(); ++i) {
    const auto distance = [&](const Thing& object) {
      const cv::Rect2d label = labelSeenBy(camera, things[i], places[i]), other = objectSeenBy(camera, object);
      const double x = std::max({0.0, label.x - other.br().x, other.x - label.br().x});
      const double y = std::max({0.0, label.y - other.br().y, other.y - label.br().y});
      return std::hypot(x, y);
    };
    for (size_t j = 0; j < things.size(); ++j)
      EXPECT_LE(distance(things[i]), distance(things[j])) << things[i].label << ", " << things[j].label;
    EXPECT_LT(distance(things[i]), 0.05) << things[i].label;
  }
}

TEST(LabelLayout, writesSmallOnSmallObjects) {
  const auto places = placesOf({thing("die 0.98", {0.02, 0.02, 0.02}, {0.3, 0.0, 1.0}),
                                thing("cracker_box 0.98", {0.2, 0.25, 0.1}, {-0.2, 0.0, 1.0})},
                               LabelView::ofCamera(kCamera));
  EXPECT_EQ(places[0].size, 0.012);
  EXPECT_EQ(places[1].size, 0.024);
}

TEST(LabelLayout, pilesLabelsUpForAViewerThatMayBeAnywhere) {
  const Thing box = thing("box 0.98", {0.1, 0.1, 0.1}, {0.0, 0.0, 1.0});
  const auto places = placesOf({box, box, box}, LabelView());
  for (size_t i = 1; i < places.size(); ++i) {
    EXPECT_EQ(places[i].center.x(), 0.0);
    EXPECT_GT(places[i].center.z(), places[i - 1].center.z() + places[i].size);
  }
}

}  // namespace
}  // namespace recognition
