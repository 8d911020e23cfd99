#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "meshes/sample_meshes.h"
#include "core/depth_noise.h"
#include "meshes/mesh_renderer.h"
#include "rgbd_recognition/training/fiducial_board.h"
#include "rgbd_recognition/training/recorded_object.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {

/// The print of a board as a mesh in the board's plane, `scale` times as large as described.
inline TexturedMesh boardMesh(const FiducialBoard& board, double scale = 1.0) {
  TexturedMesh mesh;
  cv::cvtColor(board.draw(3000.0), mesh.texture, cv::COLOR_GRAY2BGR);
  const auto w = static_cast<float>(0.5 * scale * board.size().x()),
             h = static_cast<float>(0.5 * scale * board.size().y());
  mesh.vertices = {{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
  mesh.normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Camera that looks at `target` in the board's frame from an azimuth and elevation (degrees) and a distance (metres).
inline Pose orbitPose(double azimuth, double elevation, double distance, const Eigen::Vector3d& target) {
  const double a = azimuth * CV_PI / 180.0, e = elevation * CV_PI / 180.0;
  const Eigen::Vector3d back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
  Pose camera_from_board = Pose::Identity();
  const Eigen::Vector3d z = -back, x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera_from_board.linear().row(0) = x;
  camera_from_board.linear().row(1) = z.cross(x);
  camera_from_board.linear().row(2) = z;
  camera_from_board.translation() = -camera_from_board.linear() * (target + distance * back);
  return camera_from_board;
}

/// An object on a board, and a Kinect-like camera around it.
class Turntable {
 public:
  CameraModel camera{640, 480, 525.0, 525.0, 319.5, 239.5};

  /// `place`: of the object's frame on the board.
  Turntable(const FiducialBoard& board, const TexturedMesh& object, const Pose& place, double board_scale = 1.0)
      : renderer_({{std::make_shared<TexturedMesh>(boardMesh(board, board_scale))},
                   {std::make_shared<TexturedMesh>(object), place}}) {}

  RgbdFrame view(const Pose& camera_from_board, std::uint64_t seed) const {
    const RenderedView seen = renderer_.render(camera, 2, camera_from_board);
    cv::RNG rng(seed);
    RgbdFrame frame;
    frame.color_camera = camera;
    frame.color = seen.color.clone();
    cv::GaussianBlur(frame.color, frame.color, cv::Size(), 0.6);
    cv::Mat noise(frame.color.size(), CV_16SC3);
    rng.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(frame.color, noise, frame.color, cv::noArray(), CV_8U);
    frame.depth = seen.depth.clone();
    for (int v = 0; v < frame.depth.rows; ++v)
      for (int u = 0; u < frame.depth.cols; ++u) {
        auto& z = frame.depth.at<float>(v, u);
        if (z > 0.0f) z += static_cast<float>(rng.gaussian(depthSigma(z)));
      }
    return frame;
  }

 private:
  MeshRenderer renderer_;
};

inline FiducialBoard shippedBoard(const std::string& name) {
  return FiducialBoard::fromYaml(std::string(RGBD_SOURCE_DIR) + "/config/boards/" + name + ".yaml");
}

inline FiducialBoard charuco() { return shippedBoard("charuco"); }

/// View i of a turn of `views`.
inline RgbdFrame viewOfTurn(const Turntable& turntable, int i, int views, double elevation = 40.0) {
  return turntable.view(orbitPose(360.0 * i / views, elevation, 0.7, {0, 0, 0.05}), static_cast<std::uint64_t>(i));
}

inline std::vector<RgbdFrame> recordTurn(const Turntable& turntable, int views, double elevation = 40.0) {
  std::vector<RgbdFrame> frames;
  for (int i = 0; i < views; ++i) frames.push_back(viewOfTurn(turntable, i, views, elevation));
  return frames;
}

/// What build() says.
inline std::string reasonAgainst(RecordedObject& object) {
  try {
    const auto report = object.build("box", {}).report;
    return "built: residual " + std::to_string(report.residual) + ", carved " + std::to_string(report.carved) +
           ", spread " + std::to_string(report.board_spread);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

}  // namespace recognition
