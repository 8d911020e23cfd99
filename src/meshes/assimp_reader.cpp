#include <set>
#include <stdexcept>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "meshes/files_beside.h"
#include "meshes/mesh_readers.h"

namespace recognition {
namespace {

/// By its own format only (of glTF in both versions): Assimp would try some forty others, whatever the name of the file.
void keepImporters(Assimp::Importer& importer, const std::string& extension) {
  for (size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* const one = importer.GetImporter(i);
    std::set<std::string> extensions;
    one->GetExtensionList(extensions);
    if (extensions.count(extension.substr(1))) continue;
    importer.UnregisterLoader(one);
    delete one;  // which is ours then
  }
  if (importer.GetImporterCount() == 0) throw std::runtime_error("Assimp was built without " + extension);
}

cv::Vec3b inBytes(const aiColor4D& color) {
  return {cv::saturate_cast<uchar>(color.r * 255.0f), cv::saturate_cast<uchar>(color.g * 255.0f),
          cv::saturate_cast<uchar>(color.b * 255.0f)};
}

cv::Mat imageInside(const aiTexture& texture, const std::string& name) {
  if (texture.mHeight == 0)  // compressed, width is the number of bytes
    return decodeTexture({reinterpret_cast<const char*>(texture.pcData), texture.mWidth}, name);
  cv::Mat image(static_cast<int>(texture.mHeight), static_cast<int>(texture.mWidth), CV_8UC3);
  for (unsigned i = 0; i < texture.mHeight * texture.mWidth; ++i) {
    const aiTexel& texel = texture.pcData[i];
    image.at<cv::Vec3b>(static_cast<int>(i / texture.mWidth), static_cast<int>(i % texture.mWidth)) = {texel.b, texel.g,
                                                                                                       texel.r};
  }
  return image;
}

RawMaterial convert(const aiMaterial& material, const aiScene& scene) {
  RawMaterial result;
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) result.name = name.C_Str();
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name) == AI_SUCCESS && name.length > 0) {
    result.texture = name.C_Str();
    if (const aiTexture* inside = scene.GetEmbeddedTexture(name.C_Str()))
      result.image = imageInside(*inside, result.texture);
  }
  aiColor4D color;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) result.color = inBytes(color);
  return result;
}

/// Where a material's texture lies: on which of a mesh's sets of texture coordinates, moved and scaled how.
struct TexturePlace {
  unsigned set = 0;
  Eigen::Array2f scale{1.0f, 1.0f}, offset{0.0f, 0.0f};

  explicit TexturePlace(const aiMaterial& material) {
    int index = 0;
    material.Get(AI_MATKEY_UVWSRC(aiTextureType_DIFFUSE, 0), index);
    if (index > 0 && index < AI_MAX_NUMBER_OF_TEXTURECOORDS) set = static_cast<unsigned>(index);
    aiUVTransform transform;
    if (material.Get(AI_MATKEY_UVTRANSFORM(aiTextureType_DIFFUSE, 0), transform) != AI_SUCCESS) return;
    if (transform.mRotation != 0.0f) throw std::runtime_error("has a texture that is rotated, which is not read");
    scale = {transform.mScaling.x, transform.mScaling.y};
    offset = {transform.mTranslation.x, transform.mTranslation.y};
  }
};

class Converter {
 public:
  explicit Converter(const aiScene& scene) {
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) mesh_.materials.push_back(convert(*scene.mMaterials[i], scene));
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) places_.emplace_back(*scene.mMaterials[i]);
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) has_colors_ |= scene.mMeshes[i]->HasVertexColors(0);
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) add(*scene.mMeshes[i]);
  }
  RawMesh take() { return std::move(mesh_); }

 private:
  void add(const aiMesh& part) {
    const auto first = static_cast<std::int64_t>(mesh_.positions.size());
    const auto first_normal = static_cast<std::int64_t>(mesh_.normals.size());
    const auto first_coordinate = static_cast<std::int64_t>(mesh_.coordinates.size());
    const TexturePlace& place = places_.at(part.mMaterialIndex);
    const bool has_coordinates = part.HasTextureCoords(place.set);
    const cv::Vec3b plain = plainColor(part.mMaterialIndex);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      mesh_.positions.emplace_back(part.mVertices[i].x, part.mVertices[i].y, part.mVertices[i].z);
      if (part.HasNormals()) mesh_.normals.emplace_back(part.mNormals[i].x, part.mNormals[i].y, part.mNormals[i].z);
      if (has_coordinates) {
        const aiVector3D& at = part.mTextureCoords[place.set][i];
        mesh_.coordinates.emplace_back(Eigen::Array2f(at.x, at.y) * place.scale + place.offset);
      }
      if (has_colors_)  // of any part: then those without have their material's
        mesh_.position_colors.push_back(part.HasVertexColors(0) ? inBytes(part.mColors[0][i]) : plain);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      mesh_.faces.push_back({mesh_.corners.size(), 3, static_cast<int>(part.mMaterialIndex)});
      for (unsigned k = 0; k < 3; ++k) {
        const std::int64_t at = face.mIndices[k];
        mesh_.corners.push_back({at < part.mNumVertices ? first + at : -1, has_coordinates ? first_coordinate + at : -1,
                                 part.HasNormals() ? first_normal + at : -1});
      }
    }
  }

  cv::Vec3b plainColor(unsigned material) const {
    const cv::Vec3b white(255, 255, 255);
    return material < mesh_.materials.size() ? mesh_.materials[material].color.value_or(white) : white;
  }

  RawMesh mesh_;
  std::vector<TexturePlace> places_;  // by material
  bool has_colors_ = false;
};

}  // namespace

RawMesh readThroughAssimp(const std::string& file, const std::string& extension) {
  Assimp::Importer importer;
  keepImporters(importer, extension);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // as ROS takes such meshes
  const aiScene* scene = importer.ReadFile(file, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                                     aiProcess_SortByPType | aiProcess_PreTransformVertices);
  if (!scene)
    throw std::runtime_error("is no " + extension +
                             " file that can be read: damaged, without faces, or packed in a way " +
                             "that is not known; save it as PLY or OBJ");
  return Converter(*scene).take();
}

}  // namespace recognition
