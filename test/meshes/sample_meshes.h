#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// A texture full of blobs of many sizes, each face of a box in its own cell of a 3 x 2 atlas.
inline cv::Mat blobTexture(int size, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat texture(size, size, CV_8UC3, cv::Scalar(90, 120, 140));
  for (int i = 0; i < 700; ++i) {
    const cv::Point centre(rng.uniform(0, size), rng.uniform(0, size));
    const cv::Scalar color(rng.uniform(0, 256), rng.uniform(0, 256), rng.uniform(0, 256));
    cv::ellipse(texture, centre, cv::Size(rng.uniform(3, size / 40), rng.uniform(3, size / 40)), rng.uniform(0, 180), 0,
                360, color, -1, cv::LINE_AA);
  }
  return texture;
}

/// An axis-aligned box around the origin, `size` metres, with sharp normals; face k fills cell k of a 3 x 2 atlas.
inline TexturedMesh boxMesh(const Eigen::Vector3f& size, const cv::Mat& texture) {
  TexturedMesh mesh;
  mesh.texture = texture;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const float side = face % 2 ? 1.0f : -1.0f;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 4; ++corner) {
      const float a = corner % 2 ? 1.0f : 0.0f;
      const float b = corner / 2 ? 1.0f : 0.0f;
      Eigen::Vector3f p, normal = Eigen::Vector3f::Zero();
      p[axis] = side * 0.5f;
      p[(axis + 1) % 3] = side * (a - 0.5f);
      p[(axis + 2) % 3] = b - 0.5f;
      normal[axis] = side;
      mesh.vertices.push_back(p.cwiseProduct(size));
      mesh.normals.push_back(normal);
      mesh.texture_coordinates.emplace_back((static_cast<float>(axis) + 0.02f + 0.96f * a) / 3.0f,
                                            (static_cast<float>(face % 2) + 0.02f + 0.96f * b) / 2.0f);
    }
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
  }
  return mesh;
}

/// Of a point from the surface of boxMesh(size), metres.
inline double distanceToBox(const Eigen::Vector3f& p, const Eigen::Vector3f& size) {
  const Eigen::Vector3f d = p.cwiseAbs() - 0.5f * size;
  return d.maxCoeff() <= 0.0f ? -d.maxCoeff() : d.cwiseMax(0.0f).norm();
}

}  // namespace recognition
