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

/// Reads PLY, OBJ, GLB, glTF, DAE or STL. `unit` is the length of the file's unit in metres (BOP: 0.001). Colours come
/// from textures, else from faces, vertices or materials. Several textures, and plain colours beside textures, are
/// packed into one. Textures and MTL files are looked for beside the mesh, too.
///
/// Throws std::runtime_error with file and reason: unreadable, no faces, texture or MTL missing, a face that has no
/// colour where others have one, texture coordinates without a texture (unless `untextured` says that it is meant),
/// size not plausible (extent outside 1 mm .. 5 m), origin far away from the object.
TexturedMesh readMesh(const std::string& file, double unit, bool untextured = false);

/// Longest side of the box around the mesh, metres.
double longestSide(const TexturedMesh& mesh);

/// Whether the mesh has a texture, or vertex colours that differ.
bool hasColors(const TexturedMesh& mesh);

/// Side of a texel on the surface, metres, averaged over the surface; 0 without a texture.
double texelSize(const TexturedMesh& mesh);

/// Eight hexadecimal digits that change with anything in the mesh: geometry, texture.
std::string meshChecksum(const TexturedMesh& mesh);

/// One object of a BOP `models` folder.
struct BopModel {
  int id = 0;
  std::string name;        ///< from models_info.json, made fit for a store and unique; else "obj_NNNNNN"
  std::string file;        ///< obj_NNNNNN.ply
  std::string given_name;  ///< as models_info.json has it, if that is another
};

/// All objects of a BOP `models` folder in order of id. Throws std::runtime_error with file and reason.
std::vector<BopModel> listBopModels(const std::string& directory);

}  // namespace recognition
