// Colours of GLB files: textures inside, further sets of texture coordinates, moved textures, parts of several kinds.
#include <cstdint>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meshes/mesh_files.h"

namespace recognition {
namespace {

/// A box as GLB: four vertices a side, sides 0 to 2 and 3 to 5 as two parts.
class Glb {
 public:
  using Coordinate = std::function<std::array<double, 2>(int side, size_t corner)>;

  explicit Glb(const ColoredBox& box) : box_(box) {
    std::string places, indices, colors;
    for (int side = 0; side < 6; ++side)
      for (size_t k = 0; k < 4; ++k) {
        for (const double value : box.corners[static_cast<size_t>(box.sides[static_cast<size_t>(side)][k])])
          put(value, &places);
        for (int c = 2; c >= 0; --c) put(box.colors[static_cast<size_t>(side)][c] / 255.0, &colors);
      }
    for (int side = 0; side < 3; ++side)
      for (const int k : {0, 1, 2, 0, 2, 3}) {
        const auto index = static_cast<std::uint16_t>(4 * side + k);
        indices.append(reinterpret_cast<const char*>(&index), sizeof index);
      }
    for (const int part : {0, 1}) {
      position_[part] = add(places.substr(static_cast<size_t>(part) * 144, 144), 5126, 12, "VEC3",
                            R"(,"min":[-0.05,-0.075,-0.1],"max":[0.05,0.075,0.1])");
      color_[part] = add(colors.substr(static_cast<size_t>(part) * 144, 144), 5126, 12, "VEC3", "");
    }
    indices_ = add(indices, 5123, 18, "SCALAR", "");
  }

  /// Texture coordinates of a part, from the upper left as glTF counts them.
  int coordinates(int part, const Coordinate& coordinate) {
    std::string bytes;
    for (int side = 3 * part; side < 3 * part + 3; ++side)
      for (size_t k = 0; k < 4; ++k) {
        const auto uv = coordinate(side, k);
        put(uv[0], &bytes);
        put(1.0 - uv[1], &bytes);
      }
    return add(bytes, 5126, 12, "VEC2", "");
  }

  void image(const cv::Mat& picture, const std::string& extension, const std::string& type) {
    std::vector<uchar> packed;
    cv::imencode(extension, picture, packed);
    image_view_ = view(std::string(packed.begin(), packed.end()));
    image_type_ = type;
  }

  void part(int part, const std::string& more_attributes, int material) {
    primitives_ += (primitives_.empty() ? "" : ",") + std::string(R"({"attributes":{"POSITION":)") +
                   std::to_string(position_[part]) + more_attributes + R"(},"indices":)" + std::to_string(indices_) +
                   R"(,"material":)" + std::to_string(material) + "}";
  }
  std::string color(int part) const { return R"(,"COLOR_0":)" + std::to_string(color_[part]); }

  std::string bytes(const std::string& materials) const {
    std::string json =
        R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_texture_transform"],"scene":0,"scenes":[{"nodes":[0]}],)"
        R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)" +
        primitives_ + R"(]}],"materials":[)" + materials + "]";
    if (image_view_ >= 0)
      json += R"(,"textures":[{"source":0}],"images":[{"bufferView":)" + std::to_string(image_view_) +
              R"(,"mimeType":")" + image_type_ + R"("}])";
    json += R"(,"buffers":[{"byteLength":)" + std::to_string(binary_.size()) + R"(}],"bufferViews":[)" + views_ +
            R"(],"accessors":[)" + accessors_ + "]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto number = [](size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&word), sizeof word);
    };
    return "glTF" + number(2) + number(28 + json.size() + binary_.size()) + number(json.size()) + "JSON" + json +
           number(binary_.size()) + std::string("BIN\0", 4) + binary_;
  }

 private:
  static void put(double value, std::string* bytes) {
    const auto number = static_cast<float>(value);
    bytes->append(reinterpret_cast<const char*>(&number), sizeof number);
  }

  int view(const std::string& bytes) {
    views_ += (views_.empty() ? "" : ",") + std::string(R"({"buffer":0,"byteOffset":)") +
              std::to_string(binary_.size()) + R"(,"byteLength":)" + std::to_string(bytes.size()) + "}";
    binary_ += bytes;
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    return view_count_++;
  }

  int add(const std::string& bytes, int type, int count, const std::string& shape, const std::string& more) {
    accessors_ += (accessors_.empty() ? "" : ",") + std::string(R"({"bufferView":)") + std::to_string(view(bytes)) +
                  R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" + std::to_string(count) +
                  R"(,"type":")" + shape + "\"" + more + "}";
    return accessor_count_++;
  }

  const ColoredBox& box_;
  std::string binary_, views_, accessors_, primitives_, image_type_;
  int view_count_ = 0, accessor_count_ = 0, image_view_ = -1;
  int position_[2] = {}, color_[2] = {}, indices_ = 0;
};

class MeshGlb : public testing::Test {
 protected:
  double worst(const Glb& glb, const std::string& materials) {
    writeText(directory_ / "box.glb", glb.bytes(materials));
    return worstColor(readMesh(directory_ / "box.glb", 1.0), box_);
  }

  static std::string attribute(int set, int accessor) {
    return R"(,"TEXCOORD_)" + std::to_string(set) + R"(":)" + std::to_string(accessor);
  }

  const ColoredBox box_;
  TemporaryDirectory directory_;
};

std::array<double, 2> right(int side, size_t corner) { return ColoredBox::coordinate(side, 6, corner); }

TEST_F(MeshGlb, TextureInsideAsPngOrJpeg) {
  for (const auto& [extension, type] :
       {std::pair<const char*, const char*>{".png", "image/png"}, {".jpg", "image/jpeg"}}) {
    Glb glb(box_);
    glb.image(box_.texture(0, 6), extension, type);
    for (const int part : {0, 1}) glb.part(part, attribute(0, glb.coordinates(part, right)), 0);
    EXPECT_LT(worst(glb, R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"), 12.0) << extension;
  }
}

TEST_F(MeshGlb, TextureOnTheSecondSetOfCoordinates) {
  Glb glb(box_);
  glb.image(box_.texture(0, 6), ".png", "image/png");
  for (const int part : {0, 1}) {
    const int wrong = glb.coordinates(part, [](int, size_t corner) { return right(2, corner); });
    glb.part(part, attribute(0, wrong) + attribute(1, glb.coordinates(part, right)), 0);
  }
  EXPECT_LT(worst(glb, R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}}})"), 2.0);
}

TEST_F(MeshGlb, TextureThatIsMovedAndScaled) {
  Glb glb(box_);
  glb.image(box_.texture(0, 6), ".png", "image/png");
  for (const int part : {0, 1})
    glb.part(
        part,
        attribute(0, glb.coordinates(part,
                                     [](int side, size_t corner) {
                                       const auto uv = right(side, corner);
                                       return std::array<double, 2>{2.0 * (uv[0] - 0.25), 1.0 - (0.9 - uv[1]) / 0.8};
                                     })),
        0);
  EXPECT_LT(worst(glb, R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":)"
                       R"({"KHR_texture_transform":{"offset":[0.25,0.1],"scale":[0.5,0.8]}}}}})"),
            2.0);
}

TEST_F(MeshGlb, PartsWithATextureAndWithColoursOfVertices) {
  Glb glb(box_);
  glb.image(box_.texture(0, 6), ".png", "image/png");
  glb.part(0, attribute(0, glb.coordinates(0, right)), 0);
  glb.part(1, glb.color(1), 1);
  EXPECT_LT(worst(glb, R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},{})"), 2.0);
}

}  // namespace
}  // namespace recognition
