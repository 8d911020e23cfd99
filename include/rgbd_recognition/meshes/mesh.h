#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace recognition {

/// A triangle mesh with a texture, object frame, metres.
struct TexturedMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;  ///< per vertex, unit
  std::vector<Eigen::Vector2f>
      texture_coordinates;  ///< per vertex; (0, 0) is the texture's lower left; empty without texture
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<cv::Vec3b> vertex_colors;  ///< RGB per vertex; used where there is no texture; may be empty
  cv::Mat texture;                       ///< CV_8UC3 BGR; may be empty
};

/// Reads PLY or OBJ through Assimp; `unit` is the length of the file's unit in metres (BOP: 0.001). Throws
/// std::runtime_error with file and reason: unreadable, no faces, texture missing, size not plausible (extent outside 1
/// mm .. 5 m).
TexturedMesh readMesh(const std::string& file, double unit);

/// Eight hexadecimal digits that change with anything in the mesh: geometry, texture.
std::string meshChecksum(const TexturedMesh& mesh);

/// One object of a BOP `models` folder.
struct BopModel {
  int id = 0;
  std::string name;  ///< from models_info.json, else "obj_NNNNNN"
  std::string file;  ///< obj_NNNNNN.ply
};

/// All objects of a BOP `models` folder in order of id. Throws std::runtime_error with file and reason.
std::vector<BopModel> listBopModels(const std::string& directory);

}  // namespace recognition
