#include "rgbd_recognition/meshes/mesh.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "model/temporary_directory.h"

namespace recognition {
namespace {

using testing::HasSubstr;

// A unit square in two triangles; millimetres.
const char* kPly =
    "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\nproperty float x\nproperty float "
    "y\nproperty float z\n"
    "property float texture_u\nproperty float texture_v\nelement face 2\nproperty list uchar int "
    "vertex_indices\nend_header\n"
    "0 0 0 0 0\n100 0 0 1 0\n100 50 0 1 1\n0 50 0 0 1\n3 0 1 2\n3 0 2 3\n";
const char* kObj =
    "mtllib skin.mtl\nv 0 0 0\nv 0.1 0 0\nv 0.1 0.05 0\nv 0 0.05 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\n"
    "f 1/1 2/2 3/3 4/4\n";

class MeshFile : public testing::Test {
 protected:
  void writeSkin() { cv::imwrite(directory_ / "skin.png", cv::Mat(8, 8, CV_8UC3, cv::Scalar(1, 2, 3))); }

  std::string reasonFor(const std::string& name, const std::string& text, double unit = 0.001) {
    writeText(directory_ / name, text);
    try {
      readMesh(directory_ / name, unit);
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
      return error.what();
    }
    return "read";
  }

  static void expectSquare(const TexturedMesh& mesh) {
    ASSERT_EQ(mesh.triangles.size(), 2u);
    ASSERT_EQ(mesh.vertices.size(), 4u);
    ASSERT_EQ(mesh.texture_coordinates.size(), 4u);
    ASSERT_EQ(mesh.texture.size(), cv::Size(8, 8));
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(mesh.vertices[i].x(), 0.1f * mesh.texture_coordinates[i].x(), 1e-6f);
      EXPECT_NEAR(mesh.vertices[i].y(), 0.05f * mesh.texture_coordinates[i].y(), 1e-6f);
      EXPECT_NEAR(std::abs(mesh.normals[i].z()), 1.0f, 1e-6f);
    }
  }

  TemporaryDirectory directory_;
};

TEST_F(MeshFile, ReadsPlyWithTextureNamedInAComment) {
  writeSkin();
  writeText(directory_ / "square.ply", kPly);
  expectSquare(readMesh(directory_ / "square.ply", 0.001));
}

TEST_F(MeshFile, ReadsObjWithMaterial) {
  writeSkin();
  writeText(directory_ / "skin.mtl", "newmtl skin\nmap_Kd skin.png\n");
  writeText(directory_ / "square.obj", kObj);
  expectSquare(readMesh(directory_ / "square.obj", 1.0));
}

TEST_F(MeshFile, ReadsVertexColours) {
  writeText(
      directory_ / "colours.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\n"
      "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 0 0\n100 0 0 255 0 0\n100 50 0 255 0 0\n3 0 1 2\n");
  const TexturedMesh mesh = readMesh(directory_ / "colours.ply", 0.001);
  ASSERT_EQ(mesh.vertex_colors.size(), 3u);
  EXPECT_EQ(mesh.vertex_colors[0], cv::Vec3b(255, 0, 0));
  EXPECT_TRUE(mesh.texture.empty());
}

TEST_F(MeshFile, SaysWhatIsWrong) {
  EXPECT_THROW(readMesh(directory_ / "absent.ply", 1.0), std::runtime_error);
  EXPECT_THAT(reasonFor("missing_texture.ply", kPly), HasSubstr("texture skin.png is missing"));
  writeText(directory_ / "skin.png", "no image");
  EXPECT_THAT(reasonFor("broken_texture.ply", kPly), HasSubstr("no readable image"));
  writeSkin();
  EXPECT_THAT(reasonFor("km_wide.ply", kPly, 10.0), HasSubstr("1000"));
  EXPECT_THAT(reasonFor("tiny.ply", kPly, 1e-6), HasSubstr("unit"));
  EXPECT_NE(reasonFor("text.ply", "hello"), "read");
  EXPECT_NE(reasonFor("empty.obj", ""), "read");
  EXPECT_NE(reasonFor("points.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
                      "z\nend_header\n0 0 0\n"),
            "read");
  EXPECT_NE(reasonFor("index.ply", std::string(kPly).replace(std::string(kPly).rfind("0 2 3"), 5, "0 2 9")), "read");
}

TEST_F(MeshFile, PromisesNoMoreThanItHolds) {
  const std::string four = "element vertex 4";
  for (const char* count : {"4000000000", "-1", "99999999999999999999", "many"})
    EXPECT_THAT(reasonFor("promises.ply", std::string(kPly).replace(std::string(kPly).find(four), four.size(),
                                                                    std::string("element vertex ") + count)),
                HasSubstr("more than the file can hold"))
        << count;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.rfind(what), what.size(), by);
}

TEST_F(MeshFile, HoldsWhatAPlyHeaderDeclares) {
  EXPECT_THAT(reasonFor("no_end.ply", replaced(kPly, "end_header", "end")), HasSubstr("'end' in its header"));
  const std::string ply = kPly;
  EXPECT_THAT(reasonFor("cut_header.ply", ply.substr(0, ply.find("element face"))), HasSubstr("ends too early"));
  EXPECT_THAT(reasonFor("cut.ply", replaced(kPly, "3 0 2 3\n", "")), HasSubstr("ends too early"));
  EXPECT_THAT(reasonFor("short.ply", replaced(kPly, "3 0 2 3\n", "3 0 2\n")), HasSubstr("a line is too short"));
  EXPECT_THAT(reasonFor("none.ply", replaced(kPly, "3 0 2 3\n", "0\n")), HasSubstr("without corners"));
  EXPECT_THAT(reasonFor("real.ply", replaced(kPly, "3 0 2 3\n", "3 0 2 3.5\n")), HasSubstr("no number"));
  EXPECT_THAT(reasonFor("minus.ply", replaced(kPly, "100 0 0", "100-5 0 0")), HasSubstr("no number"));
  EXPECT_THAT(reasonFor("name.ply", replaced(kPly, "float z", "float")), HasSubstr("without a name"));
  EXPECT_THAT(reasonFor("apart.ply", replaced(kPly, "element vertex 4", "property float w\nelement vertex 4")),
              HasSubstr("apart"));
  EXPECT_THAT(reasonFor("list.ply", replaced(kPly, "3 0 2 3\n", "4000000000 0 2 3\n")), HasSubstr("too long"));
  EXPECT_THAT(reasonFor("twice.ply", replaced(kPly, "end_header", "element face 9\nend_header")), HasSubstr("twice"));
  EXPECT_THAT(reasonFor("type.ply", replaced(kPly, "list uchar", "list thing")), HasSubstr("type 'thing'"));
  EXPECT_THAT(reasonFor("type.ply", replaced(kPly, "list uchar", "list float")), HasSubstr("no integer"));
  writeSkin();
  EXPECT_EQ(reasonFor("no_last_end.ply", replaced(kPly, "3 0 2 3\n", "3 0 2 3")), "read");
  EXPECT_EQ(reasonFor("comments.ply", replaced(kPly, "element face", "comment of us\nelement face")), "read");
}

TEST_F(MeshFile, HoldsItsBinaryLists) {
  const auto mesh = [](const std::string& format, const std::string& faces) {
    return "ply\nformat " + format + " 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\n" +
           "element face 1\nproperty list int uchar vertex_indices\nend_header\n" +
           std::string("\0\0\0\x64\0\0\0\x64\0", 9) + faces;
  };
  const std::string little("\3\0\0\0\0\1\2", 7), big("\0\0\0\3\0\1\2", 7);
  EXPECT_EQ(reasonFor("little.ply", mesh("binary_little_endian", little)), "read");
  EXPECT_EQ(reasonFor("big.ply", mesh("binary_big_endian", big)), "read");
  EXPECT_THAT(reasonFor("wrong.ply", mesh("binary_big_endian", little)), HasSubstr("too long"));
  EXPECT_THAT(reasonFor("less_than_none.ply", mesh("binary_big_endian", "\xff\xff\xff\xff")), HasSubstr("too long"));
  EXPECT_THAT(reasonFor("cut.ply", mesh("binary_big_endian", big.substr(0, 6))), HasSubstr("ends too early"));
  EXPECT_EQ(reasonFor("return.ply", replaced(mesh("binary_big_endian", big), "end_header", "end_header\r")), "read");
}

TEST_F(MeshFile, HasFacesOfSomeCorners) {
  const auto face = [](int corners) {
    std::string text = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.05 0\n", corner = " 1 2 3 \\\n";
    text += 'f';
    for (int i = 0; i < corners; i += 3) text += corner;
    return text + "\n";
  };
  EXPECT_EQ(reasonFor("few.obj", face(3), 1.0), "read");
  EXPECT_THAT(reasonFor("many.obj", face(6000), 1.0), HasSubstr("too many corners"));
}

TEST_F(MeshFile, IsReadAsWhatItsNameSays) {
  const std::string off = "OFF\n3 1 0\n0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n";
  EXPECT_THAT(reasonFor("triangle.off", off), HasSubstr("none of .ply, .obj"));
  EXPECT_NE(reasonFor("triangle.ply", off), "read");
  EXPECT_NE(reasonFor("square.obj", kPly), "read");
  writeSkin();
  EXPECT_EQ(reasonFor("SQUARE.PLY", kPly), "read");
}

TEST_F(MeshFile, ListsBopModelsById) {
  writeText(directory_ / "obj_000010.ply", kPly);
  writeText(directory_ / "obj_000002.ply", kPly);
  writeText(directory_ / "notes.ply", kPly);
  writeText(directory_ / "models_info.json", R"({"2": {"name": "cup"}, "10": {"diameter": 3}})");
  const std::vector<BopModel> models = listBopModels(directory_.string());
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].name, "cup");
  EXPECT_EQ(models[0].id, 2);
  EXPECT_EQ(models[1].name, "obj_000010");
  EXPECT_EQ(models[1].given_name, "");
  EXPECT_EQ(models[1].file, directory_ / "obj_000010.ply");
  writeText(directory_ / "models_info.json", "{");
  EXPECT_THROW(listBopModels(directory_.string()), std::runtime_error);
  EXPECT_THROW(listBopModels(directory_ / "nowhere"), std::runtime_error);
}

TEST_F(MeshFile, MakesBopNamesFitForAStore) {
  for (const char* id : {"1", "2", "3", "4"}) writeText(directory_ / (std::string("obj_00000") + id + ".ply"), kPly);
  writeText(
      directory_ / "models_info.json",
      R"({"1": {"name": "cracker box"}, "2": {"name": "M\u00fcsli"}, "3": {"name": "same"}, "4": {"name": "same"}})");
  const std::vector<BopModel> models = listBopModels(directory_.string());
  ASSERT_EQ(models.size(), 4u);
  EXPECT_EQ(models[0].name, "cracker_box");
  EXPECT_EQ(models[0].given_name, "cracker box");
  EXPECT_EQ(models[1].name, "M_sli");
  EXPECT_EQ(models[2].name, "same");
  EXPECT_EQ(models[2].given_name, "");
  EXPECT_EQ(models[3].name, "same_000004");
}

}  // namespace
}  // namespace recognition
