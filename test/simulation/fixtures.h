#pragma once

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "model/temporary_directory.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "simulation/object_catalog.h"
#include "simulation/random_stream.h"
#include "simulation/shapes.h"
#include "simulation/textures.h"

namespace recognition {

inline cv::Mat plainTexture(int value) { return cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(value)); }

inline std::shared_ptr<const BodyAppearance> makeAppearance(TexturedMesh mesh,
                                                            const Finish& finish = {0.0f, 10.0f, 0.5f}) {
  return std::make_shared<BodyAppearance>(std::make_shared<const TexturedMesh>(std::move(mesh)), finish);
}

inline bool sameBits(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int v = 0; v < a.rows; ++v)
    if (!std::equal(a.ptr(v), a.ptr(v) + static_cast<size_t>(a.cols) * a.elemSize(), b.ptr(v))) return false;
  return true;
}

inline CatalogObject boxObject(int id, const Eigen::Vector3d& size, std::uint64_t seed) {
  cv::RNG rng = randomStream(seed, static_cast<std::uint64_t>(id));
  CatalogObject object;
  object.id = id;
  object.name = "box_" + std::to_string(id);
  TexturedMesh mesh = makeBox(size, makePrintTexture({384, 256}, rng));
  object.shape = convexShape(mesh);
  object.appearance = makeAppearance(std::move(mesh));
  return object;
}

/// A BOP model file (ASCII PLY in millimetres) of a mesh with its texture beside it.
inline void writeBopModel(const std::string& directory, int id, const TexturedMesh& mesh) {
  const std::string name = "obj_" + sixDigits(id);
  cv::imwrite(directory + "/" + name + ".png", mesh.texture);
  std::ofstream out(directory + "/" + name + ".ply");
  out << "ply\nformat ascii 1.0\ncomment TextureFile " << name << ".png\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
         "nz\n"
      << "property float texture_u\nproperty float texture_v\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    out << 1000.0f * mesh.vertices[i].transpose() << " " << mesh.normals[i].transpose() << " "
        << mesh.texture_coordinates[i].transpose() << "\n";
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
}

}  // namespace recognition
