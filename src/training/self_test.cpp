#include "training/self_test.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include <Eigen/Geometry>

#include <opencv2/imgproc.hpp>

#include "core/short_number.h"
#include "meshes/mesh_renderer.h"
#include "meshes/surface_sampling.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {
namespace {

const CameraModel kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};  // a Kinect's
constexpr double kDistances[] = {0.6, 1.0, 1.5};                  // metres
constexpr int kViews = 3;                                         // at each distance
constexpr double kMinInDiameters = 1.3;                           // of a distance, so that the object is in view
constexpr double kWall = 0.1;                                     // metres behind the object
constexpr double kColorNoise = 2.0;
constexpr double kDepthNoise = 0.0014;  // metres at 1 m; grows with the square of the distance
constexpr double kMaxOffset = 0.03;     // metres between the object and where it is found

struct Body {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double diameter = 0.0;

  explicit Body(const TexturedMesh& mesh) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
    centre = box.center().cast<double>();
    diameter = box.diagonal().norm();
  }
};

TexturedMesh wallAt(float z) {
  constexpr float kHalf = 4.0f;
  TexturedMesh wall;
  wall.vertices = {{-kHalf, -kHalf, z}, {kHalf, -kHalf, z}, {kHalf, kHalf, z}, {-kHalf, kHalf, z}};
  wall.normals.assign(4, Eigen::Vector3f(0.0f, 0.0f, -1.0f));
  wall.vertex_colors.assign(4, cv::Vec3b(150, 150, 150));
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  return wall;
}

Pose seenFrom(const Eigen::Vector3d& direction, double distance, const Eigen::Vector3d& centre) {
  Pose camera_from_object = Pose::Identity();
  camera_from_object.linear() =
      Eigen::Quaterniond::FromTwoVectors(direction, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
  camera_from_object.translation() = Eigen::Vector3d(0.0, 0.0, distance) - camera_from_object.linear() * centre;
  return camera_from_object;
}

/// As a camera would take it.
RgbdFrame takeFrame(const TexturedMesh& mesh, const Pose& camera_from_object, double wall_z, cv::RNG& rng) {
  const std::shared_ptr<const TexturedMesh> shared(std::shared_ptr<void>(), &mesh);
  const auto wall = std::make_shared<const TexturedMesh>(wallAt(static_cast<float>(wall_z)));
  const RenderedView view = MeshRenderer({{shared, camera_from_object}, {wall, Pose::Identity()}}).render(kCamera, 2);
  RgbdFrame frame;
  frame.color_camera = kCamera;
  cv::Mat noise(view.color.size(), CV_16SC3), color;
  rng.fill(noise, cv::RNG::NORMAL, 0.0, kColorNoise);
  cv::GaussianBlur(view.color, color, cv::Size(), 0.6);
  cv::add(color, noise, frame.color, cv::noArray(), CV_8U);
  frame.depth.create(view.depth.size(), CV_16UC1);
  for (int v = 0; v < frame.depth.rows; ++v)
    for (int u = 0; u < frame.depth.cols; ++u) {
      const double z = view.depth.at<float>(v, u);
      frame.depth.at<std::uint16_t>(v, u) =
          cv::saturate_cast<std::uint16_t>(1000.0 * (z + rng.gaussian(kDepthNoise * z * z)));
    }
  return frame;
}

bool isFound(const RecognitionResult& result, const Pose& camera_from_object, const Eigen::Vector3d& centre) {
  return std::any_of(result.detections.begin(), result.detections.end(), [&](const VerifiedHypothesis& found) {
    return (found.camera_from_object * centre - camera_from_object * centre).norm() < kMaxOffset;
  });
}

}  // namespace

SelfTest testModel(const TexturedMesh& mesh, const ObjectModel& model, FeatureParameters features,
                   const TrainingProgress& progress) {
  RecognizerParameters parameters;
  if (!model.features.count(features.descriptor) && !model.features.empty())
    features.descriptor = model.features.begin()->first;
  parameters.feature_extraction = features;
  const auto database = std::make_shared<ModelDatabase>();
  database->objects.push_back(std::make_shared<const ObjectModel>(model));
  Recognizer recognizer(parameters, database);

  const Body body(mesh);
  const std::vector<Eigen::Vector3f> directions = sphereDirections(kViews * static_cast<int>(std::size(kDistances)));
  SelfTest test;
  test.texel = texelSize(mesh);
  cv::RNG rng(1);
  size_t next = 0;
  for (const double metres : kDistances) {
    SelfTest::Distance at{metres, 0, 0};
    for (int i = 0; i < kViews; ++i) {
      if (progress) progress("self-test", static_cast<double>(next) / static_cast<double>(directions.size()));
      const Pose pose = seenFrom(directions[next++].cast<double>(), metres, body.centre);
      if (metres < kMinInDiameters * body.diameter) continue;
      ++at.views;
      const RgbdFrame frame = takeFrame(mesh, pose, metres + 0.5 * body.diameter + kWall, rng);
      at.found += isFound(recognizer.recognize(frame), pose, body.centre);
    }
    test.distances.push_back(at);
  }
  return test;
}

std::string describe(const SelfTest& test) {
  std::string text = "self-test (rendered, 640x480): found";
  int found = 0;
  for (const SelfTest::Distance& at : test.distances) {
    text += &at == &test.distances.front() ? " " : ", ";
    text += at.views > 0 ? std::to_string(at.found) + " of " + std::to_string(at.views) : "none";
    text += " at " + shortNumber(at.metres) + " m" + (at.views > 0 ? "" : " (not tried, too near for its size)");
    found += at.found;
  }
  if (test.texel > 0.0) text += "; texture of " + shortNumber(1000.0 * test.texel) + " mm a pixel";
  if (found == 0) text += "; warning: expect no detections with a camera like that";
  return text;
}

}  // namespace recognition
