#include "benchmarks/feature_pairs.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "meshes/mesh_renderer.h"

namespace recognition {
namespace {

constexpr double kDegree = CV_PI / 180.0;
constexpr int kObjects = 6;
constexpr int kMaskMargin = 4;
constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

// A Kinect's colour: lens blur, other light, noise before the Bayer pattern is filled in.
cv::Mat photograph(const cv::Mat& bgr, double gain, double gamma, cv::RNG& random) {
  cv::Mat image;
  cv::GaussianBlur(bgr, image, cv::Size(), 0.7);
  cv::Mat bayer(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const int channel = y % 2 == x % 2 ? (y % 2 == 0 ? 0 : 2) : 1;
      const double level = 255.0 * gain * std::pow(image.at<cv::Vec3b>(y, x)[channel] / 255.0, gamma);
      bayer.at<uchar>(y, x) = cv::saturate_cast<uchar>(level + random.gaussian(5.0));
    }
  cv::Mat color, gray;
  cv::cvtColor(bayer, color, cv::COLOR_BayerRG2BGR);
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat photographOf(const cv::Mat& bgr, cv::RNG& random) {
  const double gain = random.uniform(0.75, 1.15), gamma = random.uniform(0.8, 1.25);
  return photograph(bgr, gain, gamma, random);
}

Pose randomTurn(double out_of_plane, double in_plane, cv::RNG& random) {
  const double direction = random.uniform(-CV_PI, CV_PI);
  const Eigen::Vector3d axis(std::cos(direction), std::sin(direction), 0.0);
  Pose turn = Pose::Identity();
  turn.linear() = (Eigen::AngleAxisd(random.uniform(-in_plane, in_plane), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(random.uniform(0.3, 1.0) * out_of_plane, axis))
                      .toRotationMatrix();
  return turn;
}

Eigen::Vector3d centreOf(const TexturedMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box.center().cast<double>();
}

// On a grid 0.8 to 1 m in front of the camera, in any orientation.
std::vector<MeshInstance> randomScene(const std::vector<std::shared_ptr<const TexturedMesh>>& meshes, cv::RNG& random) {
  std::vector<size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), 0);
  for (size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.uniform(0, static_cast<int>(i) + 1)]);
  std::vector<MeshInstance> scene;
  for (int i = 0; i < std::min(kObjects, static_cast<int>(meshes.size())); ++i) {
    const auto& mesh = meshes[order[i]];
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(0.22 * (i % 3 - 1), 0.24 * (i / 3 - 0.5), random.uniform(0.8, 1.0));
    pose = pose * randomTurn(60 * kDegree, 180 * kDegree, random);
    pose.rotate(Eigen::AngleAxisd(random.uniform(-CV_PI, CV_PI), Eigen::Vector3d::UnitY()));
    pose.translate(-centreOf(*mesh));
    scene.push_back({mesh, pose});
  }
  return scene;
}

std::vector<MeshInstance> moved(std::vector<MeshInstance> scene, const Pose& motion) {
  for (MeshInstance& instance : scene) instance.camera_from_object = motion * instance.camera_from_object;
  return scene;
}

// About the middle of the scene, 0.7 to 1.5 times as far.
Pose randomMotion(cv::RNG& random) {
  Pose motion = Pose::Identity();
  motion.translate(Eigen::Vector3d(0.0, 0.0, 0.9 * random.uniform(0.7, 1.5)));
  motion = motion * randomTurn(35 * kDegree, 45 * kDegree, random);
  motion.translate(Eigen::Vector3d(0.0, 0.0, -0.9));
  return motion;
}

cv::Mat placesIn(const RenderedView& first, const RenderedView& second, const CameraModel& camera, const Pose& motion) {
  cv::Mat place(first.depth.size(), CV_32FC2, cv::Scalar::all(kUnseen));
  for (int v = 0; v < place.rows; ++v)
    for (int u = 0; u < place.cols; ++u) {
      const float z = first.depth.at<float>(v, u);
      if (!(z > 0.0f)) continue;
      const Eigen::Vector3d p = motion * camera.unproject(u, v, z);
      const Eigen::Vector2d m = camera.project(p);
      const cv::Point pixel(cvRound(m.x()), cvRound(m.y()));
      if (!cv::Rect(cv::Point(), place.size()).contains(pixel)) continue;
      if (second.instance.at<int>(pixel) != first.instance.at<int>(v, u)) continue;
      if (std::abs(second.depth.at<float>(pixel) - p.z()) < 0.006) place.at<cv::Vec2f>(v, u) = cv::Vec2f(m.x(), m.y());
    }
  return place;
}

cv::Mat maskOf(const RenderedView& view) {
  cv::Mat mask = view.instance >= 0;
  cv::dilate(mask, mask, cv::Mat(), cv::Point(-1, -1), kMaskMargin);
  return mask;
}

// Objects before a plain wall.
cv::Mat pictureOf(const RenderedView& view) {
  cv::Mat picture = view.color.clone();
  picture.setTo(cv::Scalar(120, 130, 135), view.instance < 0);
  return picture;
}

cv::Matx33d randomHomography(cv::Size size, cv::RNG& random) {
  const double f = 1.2 * size.width;
  const cv::Matx33d k(f, 0, 0.5 * (size.width - 1), 0, f, 0.5 * (size.height - 1), 0, 0, 1);
  const Eigen::Matrix3d turn = randomTurn(45 * kDegree, 45 * kDegree, random).linear();
  const double distance = random.uniform(0.8, 1.4);
  cv::Matx33d plane;  // the picture is the plane z = 1
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      plane(row, column) = column < 2 ? turn(row, column) : (row == 2 ? distance : 0.0);
  return k * plane * k.inv();
}

cv::Mat placesOf(const cv::Matx33d& homography, cv::Size size) {
  cv::Mat place(size, CV_32FC2, cv::Scalar::all(kUnseen));
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec3d m = homography * cv::Vec3d(u, v, 1.0);
      const cv::Point2d p(m[0] / m[2], m[1] / m[2]);
      if (p.x >= 0 && p.y >= 0 && p.x < size.width && p.y < size.height)
        place.at<cv::Vec2f>(v, u) = cv::Vec2f(p.x, p.y);
    }
  return place;
}

}  // namespace

std::vector<FeaturePair> renderedPairs(const std::string& models, int count, cv::Size size, std::uint64_t seed) {
  std::vector<std::shared_ptr<const TexturedMesh>> meshes;
  for (const BopModel& model : listBopModels(models))
    meshes.push_back(std::make_shared<TexturedMesh>(readMesh(model.file, 0.001)));
  if (meshes.empty()) throw std::runtime_error(models + " holds no models");
  const double f = 525.0 / 640.0 * size.width;
  const CameraModel camera{size.width, size.height, f, f, 0.5 * (size.width - 1), 0.5 * (size.height - 1)};
  std::vector<FeaturePair> pairs;
  for (int i = 0; i < count; ++i) {
    cv::RNG random(seed + static_cast<std::uint64_t>(i));
    const std::vector<MeshInstance> scene = randomScene(meshes, random);
    const Pose motion = randomMotion(random);
    const RenderedView first = MeshRenderer(scene).render(camera, 2),
                       second = MeshRenderer(moved(scene, motion)).render(camera, 2);
    pairs.push_back({photographOf(pictureOf(first), random), photographOf(pictureOf(second), random), maskOf(first),
                     maskOf(second), placesIn(first, second, camera, motion)});
  }
  return pairs;
}

std::vector<FeaturePair> warpedPairs(const std::vector<cv::Mat>& pictures, std::uint64_t seed) {
  std::vector<FeaturePair> pairs;
  for (size_t i = 0; i < pictures.size(); ++i) {
    cv::RNG random(seed + i);
    const cv::Matx33d homography = randomHomography(pictures[i].size(), random);
    cv::Mat warped;
    cv::warpPerspective(pictures[i], warped, homography, pictures[i].size(), cv::INTER_AREA, cv::BORDER_REPLICATE);
    const cv::Mat all(pictures[i].size(), CV_8UC1, cv::Scalar(255));
    pairs.push_back(
        {photographOf(pictures[i], random), photographOf(warped, random), all, all, placesOf(homography, all.size())});
  }
  return pairs;
}

}  // namespace recognition
