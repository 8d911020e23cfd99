// Valid files are read, in whatever form; what is no mesh of an object is refused with the reason.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meshes/files_beside.h"
#include "meshes/text_cursor.h"
#include "meshes/triangulation.h"
#include "model/temporary_directory.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {
namespace {

using testing::HasSubstr;

class MeshForm : public testing::Test {
 protected:
  TexturedMesh read(const std::string& name, const std::string& bytes) {
    writeText(directory_ / name, bytes);
    return readMesh(directory_ / name, 1.0);
  }

  std::string reason(const std::string& name, const std::string& bytes) {
    try {
      read(name, bytes);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "read";
  }

  TemporaryDirectory directory_;
};

std::string bytesOf(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

// A triangle; `first` is x of its first corner.
std::string binaryPly(const std::string& line_end, float first) {
  std::string text;
  for (const char* line : {"ply", "format binary_little_endian 1.0", "comment made by hand", "element vertex 3",
                           "property float x", "property float y", "property float z", "element face 1",
                           "property list uchar int vertex_indices", "end_header"})
    text += line + line_end;
  text += bytesOf({first, 0.0f, 0.0f, 0.1f, 0.0f, 0.0f, 0.0f, 0.1f, 0.0f}) + '\3';
  for (const std::int32_t index : {0, 1, 2}) text.append(reinterpret_cast<const char*>(&index), sizeof index);
  return text;
}

float floatOf(const char* bytes) {
  float value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

TEST_F(MeshForm, BinaryPlyWithAnyLineEndAndAnyFirstByte) {
  for (const std::string end : {"\n", "\r\n", " \n", "\t \r\n", "\r"})
    for (const char* first : {"\x0a\xd7\x23\x3c", "\x0d\x0a\x23\x3c", "\x20\x20\x20\x3c"}) {
      const TexturedMesh mesh = read("triangle.ply", binaryPly(end, floatOf(first)));
      ASSERT_EQ(mesh.vertices.size(), 3u);
      EXPECT_EQ(mesh.vertices[0].x(), floatOf(first));
      EXPECT_EQ(mesh.vertices[2].y(), 0.1f);
    }
}

TEST_F(MeshForm, PlyWithBlankLinesAndElementsInAnyOrder) {
  const TexturedMesh mesh =
      read("triangle.ply",
           "ply  \nformat ascii 1.0\n\nelement camera 1\nproperty float view_px\nelement face 1\n"
           "property list uchar int vertex_index\nproperty int flags\n\nelement vertex 3\nproperty "
           "double y\nproperty double x\nproperty double z\nelement edge 1\nproperty int v1\n"
           "end_header \n7\n3 2 1 0 9\n\n0 0.1 0  \n0.2 0 0\n\n0 0 0.3\n5\n");
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.vertices[mesh.triangles[0][0]], Eigen::Vector3f(0.0f, 0.0f, 0.3f));
  EXPECT_EQ(mesh.vertices[mesh.triangles[0][1]], Eigen::Vector3f(0.0f, 0.2f, 0.0f));
  EXPECT_EQ(mesh.vertices[mesh.triangles[0][2]], Eigen::Vector3f(0.1f, 0.0f, 0.0f));
}

TEST_F(MeshForm, TextsWithAMarkInFrontOrWithCarriageReturnsAlone) {
  const std::string mark = "\xef\xbb\xbf", obj = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n",
                    ply =
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n";
  const auto withReturns = [](std::string text) {
    std::replace(text.begin(), text.end(), '\n', '\r');
    return text;
  };
  for (const std::string& text : {mark + obj, withReturns(obj)}) EXPECT_EQ(read("a.obj", text).triangles.size(), 1u);
  for (const std::string& text : {mark + ply, withReturns(ply)}) EXPECT_EQ(read("a.ply", text).triangles.size(), 1u);
  EXPECT_THAT(reason("a.obj", mark + "mtllib none.mtl\n" + obj), HasSubstr("material library none.mtl is missing"));
}

TEST_F(MeshForm, PlyOfPointsAlone) {
  EXPECT_THAT(reason("cloud.ply",
                     "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                     "end_header\n0 0 0\n"),
              HasSubstr("cloud.ply: has no faces"));
  EXPECT_THAT(reason("flat.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
              HasSubstr("no x, y and z"));
}

TEST_F(MeshForm, ObjWithIndicesFromTheEndColoursAndLongLines) {
  const TexturedMesh mesh =
      read("square.obj",
           "# a square\r\nv 0 0 0 1 0 0\r\nv 0.1 0 0 0 1 0\r\nv 0.1 0.1 0 0 0 1\r\nv 0 0.1 0 1 1 1\r\n"
           "vn 0 0 2\r\nf -4//1 -3//1 \\\r\n -2//-1 -1//1\r\n");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.vertex_colors.size(), 4u);
  EXPECT_EQ(mesh.vertex_colors[0], cv::Vec3b(255, 0, 0));
  EXPECT_EQ(mesh.normals[0], Eigen::Vector3f(0.0f, 0.0f, 1.0f));
  EXPECT_THAT(reason("bad.obj", "v 0 0\n"), HasSubstr("line 1 is too short"));
  EXPECT_THAT(reason("bad.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("face 0 names a vertex that is not there"));
  EXPECT_THAT(reason("bad.obj", "v 0 0 0\nf a b c\n"), HasSubstr("line 2 has a face with a corner that is no number"));
}

TEST_F(MeshForm, SaysWhereItsOriginIsFarAway) {
  EXPECT_THAT(reason("far.obj", "v 400 0 0\nv 400.1 0 0\nv 400 0.1 0\nf 1 2 3\n"),
              HasSubstr("lies 400 m away from its origin"));
  EXPECT_THAT(reason("large.obj", "v 0 0 0\nv 1000 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("is 1000 m long, which is not plausible; is the unit right? (0.001 makes it 1 m)"));
}

TEST_F(MeshForm, HasNormalsThatAreSmoothButOverEdges) {
  // Two squares that meet at 90 degrees, and a third that goes on from the second by 30.
  const TexturedMesh mesh =
      read("fold.obj",
           "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0.1 0.1 0\nv 0 0.1 0.1\nv 0.1 0.1 0.1\nv 0 0.15 0.1866\n"
           "v 0.1 0.15 0.1866\nf 1 2 4 3\nf 3 4 6 5\nf 5 6 8 7\n");
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f &p = mesh.vertices[i], &n = mesh.normals[i];
    EXPECT_NEAR(n.norm(), 1.0f, 1e-5f);
    if (p.y() < 0.05f) {
      EXPECT_NEAR(n.z(), 1.0f, 1e-5f);
    }
    if (p.z() > 0.05f && p.z() < 0.15f) {
      EXPECT_NEAR(std::abs(n.y()), std::cos(0.5f * 0.5236f), 2e-3f);
    }
  }
  EXPECT_EQ(mesh.vertices.size(), 10u);  // the edge's two corners have two normals each
}

// A .glb with three coloured vertices and nothing else.
std::string glb() {
  const std::string binary = bytesOf({0.0f, 0.0f, 0.0f, 0.1f, 0.0f, 0.0f, 0.0f, 0.2f, 0.0f}) +
                             bytesOf({1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f});
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[0,0,0.3]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1}}]}],"buffers":[{"byteLength":72}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0.1,0.2,0]},)"
      R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto number = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  const auto size = static_cast<std::uint32_t>(28 + json.size() + binary.size());
  return "glTF" + number(2) + number(size) + number(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
         number(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

TEST_F(MeshForm, GlbWithColoursOfItsVertices) {
  const TexturedMesh mesh = read("triangle.glb", glb());
  ASSERT_EQ(mesh.triangles.size(), 1u);
  ASSERT_EQ(mesh.vertex_colors.size(), 3u);
  EXPECT_EQ(mesh.vertex_colors[mesh.triangles[0][1]], cv::Vec3b(0, 255, 0));
  EXPECT_NEAR(mesh.vertices[mesh.triangles[0][2]].y(), 0.2f, 1e-6f);
  EXPECT_NEAR(mesh.vertices[mesh.triangles[0][2]].z(), 0.3f, 1e-6f);
  EXPECT_THAT(reason("broken.glb", glb().substr(0, 200)), HasSubstr("is no .glb file that can be read"));
}

TEST(TextCursor, ReadsNumbersAsTheyAreWritten) {
  const std::string text = "1 -2.5 +3e2 .25 4. 1e-3 0.1234567890123456789 123456789012345678901 nan -inf 1x 7";
  TextCursor cursor(text);
  double value = 0.0;
  for (const double wanted : {1.0, -2.5, 300.0, 0.25, 4.0, 0.001, 0.1234567890123456789, 123456789012345678901.0}) {
    ASSERT_TRUE(cursor.number(&value));
    EXPECT_DOUBLE_EQ(value, wanted);
  }
  ASSERT_TRUE(cursor.number(&value));
  EXPECT_TRUE(std::isnan(value));
  ASSERT_TRUE(cursor.number(&value));
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(cursor.number(&value));
  EXPECT_FALSE(TextCursor("").number(&value));
  EXPECT_FALSE(TextCursor("-").number(&value));
  EXPECT_FALSE(TextCursor("1e").number(&value));
}

TEST(Triangulate, CoversAConcavePolygonOnce) {
  // An arrow head; its area is 0.25.
  const std::vector<Eigen::Vector3d> corners = {{0, 0, 1}, {1, 0.5, 1}, {0, 1, 1}, {0.5, 0.5, 1}};
  const auto triangles = triangulate({corners[0], corners[1], corners[2], corners[3]});
  ASSERT_EQ(triangles.size(), 2u);
  double area = 0.0;
  for (const auto& t : triangles) {
    const double z = 0.5 * (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).z();
    EXPECT_GT(z, 0.0);
    area += z;
  }
  EXPECT_NEAR(area, 0.25, 1e-12);
  EXPECT_EQ(triangulate(std::vector<Eigen::Vector3d>(6, Eigen::Vector3d::Zero())).size(), 4u);
}

TEST(DecodeTga, BearsAnyBytes) {
  std::string bytes(18, '\0');
  for (int kind = 0; kind < 16; ++kind)
    for (int bits : {0, 8, 16, 24, 32, 255}) {
      bytes[2] = static_cast<char>(kind);
      bytes[16] = static_cast<char>(bits);
      bytes[12] = bytes[13] = bytes[14] = bytes[15] = '\xff';
      EXPECT_TRUE(decodeTga(bytes).empty());
      EXPECT_TRUE(decodeTga(bytes.substr(0, 10)).empty());
    }
}

}  // namespace
}  // namespace recognition
