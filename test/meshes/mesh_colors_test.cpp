// Meshes as common programs write them have the colours that they had there, or are refused.
#include <cstdint>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meshes/mesh_files.h"

namespace recognition {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MeshColors : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return directory_ / name; }

  double worst(const std::string& name) { return worstColor(readMesh(path(name), 1.0), box_); }

  std::string reason(const std::string& name) {
    try {
      readMesh(path(name), 1.0);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "read";
  }

  std::string plyVertices(const std::string& more_header = "") const {
    std::ostringstream text;
    text << "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n" << more_header;
    return text.str();
  }

  std::string plyPlaces() const {
    std::ostringstream text;
    for (const auto& c : box_.corners) text << c[0] << ' ' << c[1] << ' ' << c[2] << "\n";
    return text.str();
  }

  // Shared corners, texture coordinates by face; `pages` textures of 6 / pages sides each.
  std::string wedgePly(int pages) const {
    std::ostringstream text;
    text << "ply\nformat ascii 1.0\n";
    for (int i = 0; i < pages; ++i) text << "comment TextureFile page" << i << ".png\n";
    text << plyVertices()
         << "element face 6\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n";
    if (pages > 1) text << "property int texnumber\n";
    text << "end_header\n" << plyPlaces();
    const int count = 6 / pages;
    for (int side = 0; side < 6; ++side) {
      text << 4;
      for (const int corner : box_.sides[static_cast<size_t>(side)]) text << ' ' << corner;
      text << " 8";
      for (size_t k = 0; k < 4; ++k) {
        const auto uv = ColoredBox::coordinate(side % count, count, k);
        text << ' ' << uv[0] << ' ' << uv[1];
      }
      if (pages > 1) text << ' ' << side / count;
      text << "\n";
    }
    return text.str();
  }

  void writePages(int pages) const {
    const int count = 6 / pages;
    for (int i = 0; i < pages; ++i)
      cv::imwrite(path("page" + std::to_string(i) + ".png"), box_.texture(count * i, count));
  }

  // `material` names the one of a side; `coordinates` says whether it has texture coordinates.
  template <typename Material, typename Coordinates>
  std::string obj(const Material& material, const Coordinates& coordinates, int count) const {
    std::ostringstream text;
    text << "mtllib box.mtl\n";
    for (const auto& c : box_.corners) text << "v " << c[0] << ' ' << c[1] << ' ' << c[2] << "\n";
    int next = 0;
    for (int side = 0; side < 6; ++side) {
      text << "usemtl " << material(side) << "\n";
      const auto& corners = box_.sides[static_cast<size_t>(side)];
      if (coordinates(side))
        for (size_t k = 0; k < 4; ++k) {
          const auto uv = ColoredBox::coordinate(side % count, count, k);
          text << "vt " << uv[0] << ' ' << uv[1] << "\n";
        }
      text << 'f';
      for (size_t k = 0; k < 4; ++k) {
        text << ' ' << corners[k] + 1;
        if (coordinates(side)) text << '/' << ++next;
      }
      text << "\n";
    }
    return text.str();
  }

  static bool always(int) { return true; }

  const ColoredBox box_;
  TemporaryDirectory directory_;
};

TEST_F(MeshColors, OfCoordinatesByCornerWithSharedVertices) {
  writePages(1);
  writeText(path("box.ply"), wedgePly(1));
  EXPECT_LT(worst("box.ply"), 2.0);
}

TEST_F(MeshColors, OfSeveralTexturesOfAPly) {
  for (const int pages : {2, 3, 6}) {
    writePages(pages);
    writeText(path("box.ply"), wedgePly(pages));
    EXPECT_LT(worst("box.ply"), 2.0) << pages;
  }
}

TEST_F(MeshColors, OfSeveralTexturesOfAnObj) {
  writePages(2);
  writeText(path("box.mtl"), "newmtl a\nmap_Kd page0.png\nnewmtl b\nmap_Kd -clamp on page1.png\n");
  writeText(path("box.obj"), obj([](int side) { return side < 3 ? "a" : "b"; }, always, 3));
  EXPECT_LT(worst("box.obj"), 2.0);
}

TEST_F(MeshColors, OfPlainMaterialsBesideATexture) {
  writePages(2);
  std::string mtl = "newmtl a\nKd 1 1 1\nmap_Kd page0.png\n";
  for (int side = 3; side < 6; ++side) {
    const cv::Vec3b& c = box_.colors[static_cast<size_t>(side)];
    mtl += "newmtl plain" + std::to_string(side) + "\nKd " + std::to_string(c[2] / 255.0) + " " +
           std::to_string(c[1] / 255.0) + " " + std::to_string(c[0] / 255.0) + "\n";
  }
  writeText(path("box.mtl"), mtl);
  const auto material = [](int side) { return side < 3 ? std::string("a") : "plain" + std::to_string(side); };
  writeText(path("box.obj"), obj(material, always, 3));
  EXPECT_LT(worst("box.obj"), 2.0);
  writeText(path("without.obj"), obj(
                                     material, [](int side) { return side < 3; }, 3));
  EXPECT_LT(worst("without.obj"), 2.0);
  writeText(path("none.obj"), obj(
                                  material, [](int side) { return side > 2; }, 3));
  EXPECT_THAT(reason("none.obj"), HasSubstr("face 0 has the texture page0.png, but no texture coordinates"));
}

TEST_F(MeshColors, OfAPageThatRepeatsBesideAnother) {
  writePages(2);
  writeText(path("box.mtl"), "newmtl a\nmap_Kd page0.png\nnewmtl b\nmap_Kd page1.png\n");
  std::string text = obj([](int side) { return side < 3 ? "a" : "b"; }, always, 3);
  std::istringstream lines(text);
  std::string moved;
  for (std::string line; std::getline(lines, line);) {
    double u = 0.0, v = 0.0;
    if (std::sscanf(line.c_str(), "vt %lf %lf", &u, &v) == 2)
      line = "vt " + std::to_string(u + 2.0) + " " + std::to_string(v - 1.0);
    moved += line + "\n";
  }
  writeText(path("box.obj"), moved);
  EXPECT_LT(worst("box.obj"), 2.0);
  moved.replace(moved.find("vt 2."), 5, "vt 900.");
  writeText(path("far.obj"), moved);
  EXPECT_THAT(reason("far.obj"), HasSubstr("repeats one of its textures too often"));
}

// Colours of vertices: 4 of its own for each side.
std::string coloredPly(const ColoredBox& box, const std::string& prefix, const std::string& type, double factor) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex 24\nproperty float x\nproperty float y\nproperty float z\n";
  for (const char* name : {"red", "green", "blue"}) text << "property " << type << ' ' << prefix << name << "\n";
  text << "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t side = 0; side < 6; ++side)
    for (const int corner : box.sides[side]) {
      const auto& c = box.corners[static_cast<size_t>(corner)];
      text << c[0] << ' ' << c[1] << ' ' << c[2];
      for (int k = 2; k >= 0; --k) {
        const double value = factor * box.colors[side][k];
        if (type == "float")
          text << ' ' << value;
        else
          text << ' ' << std::lround(value);
      }
      text << "\n";
    }
  for (int side = 0; side < 6; ++side)
    text << 4 << ' ' << 4 * side << ' ' << 4 * side + 1 << ' ' << 4 * side + 2 << ' ' << 4 * side + 3 << "\n";
  return text.str();
}

TEST_F(MeshColors, OfVerticesUnderTheirUsualNamesAndTypes) {
  for (const char* prefix : {"", "diffuse_"})
    for (const auto& [type, factor] : std::vector<std::pair<std::string, double>>{
             {"uchar", 1.0}, {"ushort", 257.0}, {"ushort", 1.0}, {"float", 1.0 / 255.0}, {"int", 1.0}}) {
      writeText(path("box.ply"), coloredPly(box_, prefix, type, factor));
      EXPECT_LT(worst("box.ply"), 2.0) << prefix << type;
    }
  writeText(path("box.ply"), coloredPly(box_, "float_", "float", 1.0));
  EXPECT_EQ(reason("box.ply"), "read");  // without colours: training refuses it
  EXPECT_FALSE(hasColors(readMesh(path("box.ply"), 1.0)));
}

TEST_F(MeshColors, OfFaces) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\n"
       << plyVertices()
       << "element face 6\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
          "property uchar blue\nend_header\n"
       << plyPlaces();
  for (size_t side = 0; side < 6; ++side) {
    text << 4;
    for (const int corner : box_.sides[side]) text << ' ' << corner;
    for (int k = 2; k >= 0; --k) text << ' ' << static_cast<int>(box_.colors[side][k]);
    text << "\n";
  }
  writeText(path("box.ply"), text.str());
  EXPECT_LT(worst("box.ply"), 2.0);
}

TEST_F(MeshColors, OfFilesFoundBesideTheMesh) {
  cv::imwrite(path("Page0.PNG"), box_.texture(0, 6));
  for (const char* name : {"page0.png", "C:\\Users\\me\\page0.png", "textures/page0.png", "/nowhere/page0.png",
                           "\"page0.png\"", "file:///home/me/page0.png", "PAGE0.png"}) {
    writeText(path("box.mtl"), std::string("newmtl a\nmap_Kd ") + name + "\n");
    writeText(path("box.obj"), obj([](int) { return "a"; }, always, 6));
    EXPECT_LT(worst("box.obj"), 2.0) << name;
  }
  std::rename(path("box.mtl").c_str(), path("BOX.MTL").c_str());
  EXPECT_LT(worst("box.obj"), 2.0);
  std::remove(path("Page0.PNG").c_str());
  EXPECT_THAT(reason("box.obj"), AllOf(HasSubstr("box.obj"), HasSubstr("texture PAGE0.png is missing")));
  std::remove(path("BOX.MTL").c_str());
  EXPECT_THAT(reason("box.obj"), HasSubstr("material library box.mtl is missing"));
}

TEST_F(MeshColors, RefusesWhatCannotBeRight) {
  writePages(1);
  std::string ply = wedgePly(1);
  const std::string named = "comment TextureFile page0.png\n";
  writeText(path("unnamed.ply"), std::string(ply).erase(ply.find(named), named.size()));
  EXPECT_THAT(reason("unnamed.ply"), HasSubstr("has texture coordinates, but names no texture"));
  EXPECT_NO_THROW(readMesh(path("unnamed.ply"), 1.0, true));
  writeText(path("box.mtl"), "newmtl other\nKd 1 0 0\nnewmtl a\nKd 1 0 0\n");
  writeText(path("box.obj"), obj([](int) { return "b"; }, always, 6));
  EXPECT_THAT(reason("box.obj"), HasSubstr("material 'b' is not in box.mtl"));
  writeText(path("box.mtl"), "newmtl b\nmap_Kd -s 2 2 1 page0.png\n");
  EXPECT_THAT(reason("box.obj"), HasSubstr("moved or scaled"));
}

std::string tga(const cv::Mat& image, bool packed, bool from_below) {
  const auto byte = [](int value) { return static_cast<char>(value); };
  std::string bytes(18, '\0');
  bytes[2] = byte(packed ? 10 : 2);
  bytes[12] = byte(image.cols), bytes[13] = byte(image.cols >> 8);
  bytes[14] = byte(image.rows), bytes[15] = byte(image.rows >> 8);
  bytes[16] = 24;
  bytes[17] = byte(from_below ? 0 : 0x20);
  for (int i = 0; i < image.rows; ++i)
    for (int u = 0; u < image.cols; u += packed ? 16 : 1) {
      if (packed) bytes += byte(0x80 | 15);
      const auto& c = image.at<cv::Vec3b>(from_below ? image.rows - 1 - i : i, u);
      for (int k = 0; k < 3; ++k) bytes += byte(c[k]);
    }
  return bytes;
}

TEST_F(MeshColors, OfATgaOrWebpTexture) {
  cv::Mat texture = box_.texture(0, 6);
  texture.rowRange(0, 1).setTo(0);  // above: rows are not turned round
  writeText(path("box.obj"), obj([](int) { return "a"; }, always, 6));
  writeText(path("box.mtl"), "newmtl a\nmap_Kd skin.tga\n");
  for (const bool packed : {false, true})
    for (const bool from_below : {false, true}) {
      writeText(path("skin.tga"), tga(texture, packed, from_below));
      EXPECT_LT(worst("box.obj"), 2.0);
      EXPECT_EQ(cv::norm(readMesh(path("box.obj"), 1.0).texture, texture, cv::NORM_INF), 0.0);
    }
  writeText(path("skin.tga"), tga(texture, false, true).substr(0, 500));
  EXPECT_THAT(reason("box.obj"), HasSubstr("no readable image"));
  writeText(path("box.mtl"), "newmtl a\nmap_Kd skin.webp\n");
  cv::imwrite(path("skin.webp"), texture, {cv::IMWRITE_WEBP_QUALITY, 101});
  EXPECT_LT(worst("box.obj"), 2.0);
}

TEST_F(MeshColors, OfADaeWithATexture) {
  writePages(1);
  std::ostringstream places, uvs, indices;
  for (const auto& c : box_.corners) places << 1000.0 * c[0] << ' ' << 1000.0 * c[1] << ' ' << 1000.0 * c[2] << ' ';
  int next = 0;
  for (int side = 0; side < 6; ++side)
    for (size_t k = 0; k < 4; ++k) {
      const auto uv = ColoredBox::coordinate(side, 6, k);
      uvs << uv[0] << ' ' << uv[1] << ' ';
      indices << box_.sides[static_cast<size_t>(side)][k] << ' ' << next++ << ' ';
    }
  std::ifstream form(RGBD_SOURCE_DIR "/test/meshes/box.dae.in");
  std::ostringstream text;
  text << form.rdbuf();
  std::string dae = text.str();
  for (const auto& [mark, value] : std::vector<std::pair<std::string, std::string>>{
           {"@PLACES@", places.str()}, {"@UVS@", uvs.str()}, {"@INDICES@", indices.str()}})
    dae.replace(dae.find(mark), mark.size(), value);
  writeText(path("box.dae"), dae);
  EXPECT_LT(worst("box.dae"), 2.0);  // its unit is the millimetre, its z points up
}

TEST_F(MeshColors, OfAnStlWithColours) {
  std::string bytes(80, ' ');
  const auto put = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t{12});
  for (size_t side = 0; side < 6; ++side)
    for (const std::array<size_t, 3>& triangle : {std::array<size_t, 3>{0, 1, 2}, {0, 2, 3}}) {
      for (int k = 0; k < 3; ++k) put(0.0f);
      for (const size_t k : triangle)
        for (const double value : box_.corners[static_cast<size_t>(box_.sides[side][k])])
          put(static_cast<float>(value));
      const cv::Vec3b& c = box_.colors[side];
      put(static_cast<std::uint16_t>(0x8000 | (c[2] >> 3) << 10 | (c[1] >> 3) << 5 | c[0] >> 3));
    }
  writeText(path("box.stl"), bytes);
  EXPECT_LT(worst("box.stl"), 9.0);  // five bits a channel
}

}  // namespace
}  // namespace recognition
