#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <opencv2/imgcodecs.hpp>

#include "meshes/sample_meshes.h"
#include "model/temporary_directory.h"
#include "rgbd_recognition/model/model_store.h"
#ifdef RGBD_RECOGNITION_HAS_BAGS
#include "bags/bag_writer.h"
#include "training/turntable.h"
#endif

namespace recognition {
namespace {

using testing::HasSubstr;

const std::string kMeshes = std::string(RGBD_TEST_DATA) + "/demo/models";

class Train : public testing::Test {
 protected:
  // Exit code of train with these arguments; what it says is in `said_`.
  int run(const std::string& arguments) {
    const std::string command = std::string(RGBD_TRAIN) + " " + arguments + " > " + (directory_ / "said") + " 2>&1";
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(directory_ / "said").rdbuf();
    said_ = text.str();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string store() const { return directory_ / "store"; }

  TemporaryDirectory directory_;
  std::string said_;
};

TEST_F(Train, FillsAStoreAndGoesOnWhereItStopped) {
  const std::string some = "--models " + store() + " --bop " + kMeshes + " --no-self-test --distances 1 --views ";
  EXPECT_EQ(run(some + "4 --objects 3"), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("points"));
  EXPECT_EQ(run(some + "4 --objects 3,10"), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("trained already"));
  const auto models = ModelStore(store()).loadAll();
  EXPECT_TRUE(models.errors.empty());
  ASSERT_EQ(models.database->objects.size(), 2u);
  EXPECT_EQ(models.database->objects[0]->challenge_id, 3);
  EXPECT_EQ(models.database->objects[0]->provenance.at("training/views"), "4");

  EXPECT_EQ(run(some + "5 --objects 3"), 1);
  EXPECT_THAT(said_, HasSubstr("overwrite or extend"));
  EXPECT_EQ(run(some + "5 --objects 3 --overwrite"), 0) << said_;
  EXPECT_EQ(ModelStore(store()).load(models.database->objects[0]->name).provenance.at("training/views"), "5");
}

TEST_F(Train, SaysWhatIsWrong) {
  const std::string models = "--models " + store();
  EXPECT_GT(run(models), 100);
  EXPECT_GT(run(models + " --mesh " + kMeshes + "/obj_000003.ply"), 100);  // no name
  EXPECT_EQ(run(models + " --bop " + kMeshes + " --objects 99"), 2);
  EXPECT_THAT(said_, HasSubstr("99"));
  EXPECT_EQ(run(models + " --bop " + kMeshes + " --views 1"), 2);
  EXPECT_THAT(said_, HasSubstr("views"));
  EXPECT_EQ(run(models + " --name box --mesh " + kMeshes + "/obj_000003.ply"), 1);  // millimetres read as metres
  EXPECT_THAT(said_, HasSubstr("unit"));
  EXPECT_EQ(run(models + " --name a/b --mesh " + kMeshes + "/obj_000003.ply --unit 0.001"), 1);
  EXPECT_THAT(said_, HasSubstr("a/b"));
  EXPECT_TRUE(ModelStore(store()).names().empty());
}

TEST_F(Train, KeepsTheStore) {
  const std::string models = "--models " + store();
  writeText(directory_ / "ids.yaml", "cracker: 7\nother: 8\n");
  ASSERT_EQ(run(models + " --mesh " + kMeshes +
                "/obj_000002.ply --unit 0.001 --name cracker --no-self-test --distances 1 --views 4 " +
                "--challenge-ids " + (directory_ / "ids.yaml")),
            0)
      << said_;
  EXPECT_EQ(ModelStore(store()).load("cracker").challenge_id, 7);
  EXPECT_EQ(run(models + " --list"), 0);
  EXPECT_THAT(said_, HasSubstr("cracker: "));
  EXPECT_THAT(said_, HasSubstr("obj_000002.ply"));
  EXPECT_EQ(run(models + " --export cracker " + (directory_ / "cracker.tar")), 0) << said_;
  EXPECT_EQ(run(models + " --rename cracker box"), 0) << said_;
  EXPECT_EQ(run("--models " + (directory_ / "other") + " --import " + (directory_ / "cracker.tar")), 0) << said_;
  EXPECT_EQ(ModelStore(directory_ / "other").names(), std::vector<std::string>{"cracker"});
  EXPECT_EQ(run(models + " --remove cracker"), 2);
  EXPECT_THAT(said_, HasSubstr("no such model"));
  EXPECT_EQ(run(models + " --remove box"), 0) << said_;
  EXPECT_TRUE(ModelStore(store()).names().empty());

  std::filesystem::create_directory(directory_ / "other/half");
  EXPECT_EQ(run("--models " + (directory_ / "other") + " --list"), 1);
  EXPECT_THAT(said_, HasSubstr("half"));
  writeText(directory_ / "ids.yaml", "cracker: seven\n");
  EXPECT_EQ(run(models + " --bop " + kMeshes + " --challenge-ids " + (directory_ / "ids.yaml")), 2);
  EXPECT_THAT(said_, HasSubstr("ids.yaml"));
}

// A box of the size of `unit`, with blobs on it or plain; PLY with a texture.
void writeBox(const std::string& folder, double unit, bool is_plain) {
  const TexturedMesh box = boxMesh({0.1f, 0.15f, 0.2f}, blobTexture(512, 3));
  cv::imwrite(folder + "/skin.png", is_plain ? cv::Mat(512, 512, CV_8UC3, cv::Scalar(90, 120, 140)) : box.texture);
  std::ofstream out(folder + "/box.ply");
  out << "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex " << box.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float u\nproperty float v\nelement face "
      << box.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (size_t i = 0; i < box.vertices.size(); ++i)
    out << box.vertices[i].transpose() * unit << ' ' << box.texture_coordinates[i].transpose() << "\n";
  for (const auto& t : box.triangles) out << 3 << ' ' << t[0] << ' ' << t[1] << ' ' << t[2] << "\n";
}

TEST_F(Train, SaysWhatRecognitionCanExpect) {
  writeBox(directory_.string(), 1.0, false);
  const std::string command = "--models " + store() + " --mesh " + (directory_ / "box.ply") + " --name box";
  EXPECT_EQ(run(command + " --distances 1 --views 30 --id 7"), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("self-test (rendered, 640x480): found 3 of 3 at 0.6 m"));
  EXPECT_THAT(said_, HasSubstr("mm a pixel"));
  EXPECT_EQ(ModelStore(store()).load("box").challenge_id, 7);
}

TEST_F(Train, GivesIdsOfItsOwn) {
  writeBox(directory_.string(), 1.0, false);
  const std::string mesh = " --mesh " + (directory_ / "box.ply") + " --no-self-test --distances 1 --views 4";
  for (const char* name : {"a", "b"}) EXPECT_EQ(run("--models " + store() + mesh + " --name " + name), 0) << said_;
  EXPECT_EQ(run("--models " + store() + mesh + " --overwrite --name a"), 0) << said_;
  EXPECT_EQ(ModelStore(store()).load("a").challenge_id, 1001);
  EXPECT_EQ(ModelStore(store()).load("b").challenge_id, 1002);
}

TEST_F(Train, RefusesWhatWouldNeverBeFound) {
  const std::string command = "--models " + store() + " --mesh " + (directory_ / "box.ply") + " --name box --views 4 ";
  writeBox(directory_.string(), 1.0, true);
  EXPECT_EQ(run(command), 1);
  EXPECT_THAT(said_, HasSubstr("next to no texture"));
  EXPECT_THAT(said_, HasSubstr("--untextured"));
  writeText(directory_ / "gray.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  EXPECT_EQ(run("--models " + store() + " --mesh " + (directory_ / "gray.obj") + " --name gray"), 1);
  EXPECT_THAT(said_, HasSubstr("has no texture, and no colours that differ"));
  EXPECT_TRUE(ModelStore(store()).names().empty());
  EXPECT_EQ(run(command + "--untextured"), 0) << said_;
  EXPECT_THAT(said_, testing::Not(HasSubstr("pcl::")));
  EXPECT_EQ(run("--models " + store() + " --list"), 0);
  EXPECT_THAT(said_, testing::Not(HasSubstr("pcl::")));
}

TEST_F(Train, AsksAboutAnUnlikelyUnit) {
  const std::string command = "--models " + store() + " --mesh " + (directory_ / "box.ply") + " --name box --views 4 ";
  writeBox(directory_.string(), 18.0, false);
  EXPECT_EQ(run(command), 1);
  EXPECT_THAT(said_, HasSubstr("is 3.6 m long if its unit is 1 m; is that right? Giving the unit 1 says so"));
  EXPECT_THAT(said_, HasSubstr("unit 0.001 makes it 0.0036 m"));
  EXPECT_TRUE(ModelStore(store()).names().empty());
}

TEST_F(Train, IsRefusedWhileAnotherWrites) {
  const ModelStore held(store());
  const auto lock = held.lock();
  EXPECT_EQ(run("--models " + store() + " --bop " + kMeshes + " --objects 3"), 2);
  EXPECT_THAT(said_, HasSubstr("another program"));
}

#ifdef RGBD_RECOGNITION_HAS_BAGS
void writeTurn(const std::string& file, const FiducialBoard& board, int pattern) {
  const Turntable turntable(board, boxMesh({0.1f, 0.06f, 0.14f}, blobTexture(512, pattern)),
                            Pose(Eigen::Translation3d(0, 0, 0.07)));
  BagWriter writer(file, openniTopics());
  for (int i = 0; i < 8; ++i)
    writer.write(turntable.view(orbitPose(45.0 * i, 40.0, 0.7, {0, 0, 0.05}), 1), (i + 10) * 100000000LL);
  writer.close();
}

TEST_F(Train, MakesAModelOfEachBagOfAFolderAndGoesOnWhereItStopped) {
  const std::string bags = directory_ / "bags";
  const std::string board_file = std::string(RGBD_SOURCE_DIR) + "/config/boards/charuco.yaml";
  std::filesystem::create_directory(bags);
  const FiducialBoard board = FiducialBoard::fromYaml(board_file);
  writeTurn(bags + "/tea.bag", board, 5);
  writeText(bags + "/broken.bag", "no bag");
  const std::string arguments = "--models " + store() + " --bags " + bags + " --board " + board_file;
  EXPECT_EQ(run(arguments), 1);  // one bag is broken; the other is trained nevertheless
  EXPECT_THAT(said_, HasSubstr("broken: not trained"));
  EXPECT_EQ(ModelStore(store()).names(), std::vector<std::string>{"tea"});

  std::filesystem::remove(bags + "/broken.bag");
  writeTurn(bags + "/coffee.bag", board, 6);
  EXPECT_EQ(run(arguments), 0) << said_;
  EXPECT_THAT(said_, HasSubstr("tea: trained already"));
  EXPECT_THAT(said_, HasSubstr("coffee: "));
  EXPECT_EQ(ModelStore(store()).names(), (std::vector<std::string>{"coffee", "tea"}));
}
#endif

}  // namespace
}  // namespace recognition
