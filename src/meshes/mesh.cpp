#include "rgbd_recognition/meshes/mesh.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "model/durable_file.h"
#include "meshes/mesh_check.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

constexpr double kMinExtent = 0.001;  // metres
constexpr double kMaxExtent = 5.0;
constexpr float kSmoothingAngle = 60.0f;  // degrees; where the file has no normals, sharper edges stay sharp

[[noreturn]] void fail(const std::string& file, const std::string& reason) {
  throw std::runtime_error(file + ": " + reason);
}

/// Assimp passes over the PLY header line "comment TextureFile NAME".
std::string plyTextureName(const std::string& file) {
  const std::string key = "comment TextureFile ";
  std::ifstream in(file, std::ios::binary);
  for (std::string line; std::getline(in, line) && line.rfind("end_header", 0) != 0;) {
    if (line.rfind(key, 0) != 0) continue;
    line.erase(line.find_last_not_of(" \r\t") + 1);
    return line.substr(std::min(line.size(), key.size()));
  }
  return "";
}

/// By its own format only: Assimp would try some forty others, whatever the name of the file.
void keepImporter(Assimp::Importer& importer, const std::string& extension) {
  Assimp::BaseImporter* const kept = importer.GetImporter(extension.c_str());
  for (size_t i = importer.GetImporterCount(); i-- > 0;)
    if (Assimp::BaseImporter* other = importer.GetImporter(i); other != kept) {
      importer.UnregisterLoader(other);
      delete other;  // which is ours then
    }
}

std::string textureName(const aiScene& scene, const std::string& file) {
  std::set<std::string> names;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    aiString name;
    const aiMaterial* material = scene.mMaterials[scene.mMeshes[m]->mMaterialIndex];
    if (material->GetTexture(aiTextureType_DIFFUSE, 0, &name) == AI_SUCCESS && name.length > 0)
      names.insert(name.C_Str());
  }
  if (names.size() > 1) fail(file, "uses " + std::to_string(names.size()) + " textures; bake them into one");
  return names.empty() ? plyTextureName(file) : *names.begin();
}

cv::Mat readTexture(const aiScene& scene, const std::string& file) {
  std::string name = textureName(scene, file);
  if (name.empty()) return {};
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path path = fs::path(file).parent_path() / name;
  if (!fs::is_regular_file(path)) fail(file, "texture " + path.string() + " is missing");
  cv::Mat texture = cv::imread(path.string(), cv::IMREAD_COLOR);
  if (texture.empty()) fail(file, "texture " + path.string() + " is no readable image");
  return texture;
}

void appendVertices(const aiMesh& part, double unit, TexturedMesh& mesh) {
  const bool textured = !mesh.texture.empty();
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& p = part.mVertices[i];
    const aiVector3D n = part.HasNormals() ? part.mNormals[i] : aiVector3D(0, 0, 0);
    mesh.vertices.push_back((Eigen::Vector3d(p.x, p.y, p.z) * unit).cast<float>());
    mesh.normals.push_back(Eigen::Vector3f(n.x, n.y, n.z).stableNormalized());
    if (textured) mesh.texture_coordinates.emplace_back(part.mTextureCoords[0][i].x, part.mTextureCoords[0][i].y);
    if (!textured && part.HasVertexColors(0)) {
      const aiColor4D& c = part.mColors[0][i];
      mesh.vertex_colors.emplace_back(cv::saturate_cast<uchar>(c.r * 255.0f), cv::saturate_cast<uchar>(c.g * 255.0f),
                                      cv::saturate_cast<uchar>(c.b * 255.0f));
    }
  }
}

void appendPart(const aiMesh& part, double unit, const std::string& file, TexturedMesh& mesh) {
  if (!mesh.texture.empty() && !part.HasTextureCoords(0)) fail(file, "has a texture, but no texture coordinates");
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  appendVertices(part, unit, mesh);
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;
    std::array<std::uint32_t, 3> triangle;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices)
        fail(file, "face " + std::to_string(f) + " names a vertex that is not there");
      triangle[k] = first + face.mIndices[k];
    }
    mesh.triangles.push_back(triangle);
  }
}

void checkGeometry(const TexturedMesh& mesh, const std::string& file) {
  if (mesh.triangles.empty()) fail(file, "has no faces");
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    if (!vertex.allFinite()) fail(file, "has a vertex that is not a finite point");
    box.extend(vertex);
  }
  const double extent = box.diagonal().maxCoeff();
  if (extent < kMinExtent || extent > kMaxExtent)
    fail(file, "is " + std::to_string(extent) + " m long, which is not plausible; is the unit right?");
  for (const Eigen::Vector2f& uv : mesh.texture_coordinates)
    if (!uv.allFinite()) fail(file, "has a texture coordinate that is not finite");
}

}  // namespace

TexturedMesh readMesh(const std::string& file, double unit) {
  if (!fs::is_regular_file(file)) fail(file, "is no file");
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension != ".ply" && extension != ".obj") fail(file, "is neither .ply nor .obj");
  extension == ".ply" ? checkPly(file) : checkObj(file);
  Assimp::Importer importer;
  keepImporter(importer, extension);
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSmoothingAngle);
  const aiScene* scene = importer.ReadFile(file, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                                     aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices |
                                                     aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (!scene) fail(file, importer.GetErrorString());
  TexturedMesh mesh;
  mesh.texture = readTexture(*scene, file);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) appendPart(*scene->mMeshes[m], unit, file, mesh);
  if (mesh.vertex_colors.size() != mesh.vertices.size()) mesh.vertex_colors.clear();
  checkGeometry(mesh, file);
  return mesh;
}

std::string meshChecksum(const TexturedMesh& mesh) {
  std::string bytes;
  const auto append = [&bytes](const auto& values) {
    if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  append(mesh.vertices);
  append(mesh.normals);
  append(mesh.texture_coordinates);
  append(mesh.triangles);
  append(mesh.vertex_colors);
  const cv::Mat texture = mesh.texture.isContinuous() ? mesh.texture : mesh.texture.clone();
  if (!texture.empty()) bytes.append(texture.ptr<char>(), texture.total() * texture.elemSize());
  return checksum(bytes);
}

}  // namespace recognition
