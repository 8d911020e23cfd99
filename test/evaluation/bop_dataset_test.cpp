#include "rgbd_recognition/evaluation/bop_dataset.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "refusal.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

/// A split of one scene with one frame, in a folder of the test's own.
class BopDataset : public testing::Test {
 protected:
  void SetUp() override {
    split_ = fs::path(testing::TempDir()) / "bop_dataset_test";
    fs::remove_all(split_);
    const fs::path scene = split_ / "000003";
    fs::create_directories(scene / "rgb");
    fs::create_directories(scene / "depth");
    cv::imwrite((scene / "rgb/000005.png").string(), cv::Mat(4, 6, CV_8UC3, cv::Scalar(1, 2, 3)));
    cv::imwrite((scene / "depth/000005.png").string(), cv::Mat(4, 6, CV_16UC1, cv::Scalar(12340)));
    write("scene_camera.json", R"({"5": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1], "depth_scale": 0.1}})");
    write("scene_gt.json",
          R"({"5": [{"obj_id": 9, "cam_R_m2c": [0, -1, 0, 1, 0, 0, 0, 0, 1], "cam_t_m2c": [10, -20, 900]}]})");
    write("scene_gt_info.json", R"({"5": [{"visib_fract": 0.75}]})");
  }

  void write(const std::string& name, const std::string& text) { std::ofstream(split_ / "000003" / name) << text; }

  std::string messageOf() {
    return refusal<std::runtime_error>([&] { readBopSplit(split_.string()); });
  }

  fs::path split_;
};

TEST_F(BopDataset, ReadsFrameCameraAndTruth) {
  const auto frames = readBopSplit(split_.string());
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].name(), "000003/000005");
  ASSERT_EQ(frames[0].ground_truth.size(), 1u);
  const GroundTruth& truth = frames[0].ground_truth[0];
  EXPECT_EQ(truth.object_id, 9);
  EXPECT_DOUBLE_EQ(truth.visibility, 0.75);
  EXPECT_NEAR((truth.camera_from_object.translation() - Eigen::Vector3d(0.01, -0.02, 0.9)).norm(), 0, 1e-12);
  EXPECT_DOUBLE_EQ(truth.camera_from_object.linear()(1, 0), 1.0);

  const RgbdFrame frame = loadBopFrame(frames[0]);
  EXPECT_NEAR(frame.depth.at<float>(0, 0), 1.234f, 1e-6f);
  EXPECT_DOUBLE_EQ(frame.color_camera.fy, 510.0);
  EXPECT_EQ(frame.color_camera.width, 6);
}

TEST_F(BopDataset, ErrorsNameTheFile) {
  write("scene_gt.json", "{ broken");
  EXPECT_THAT(messageOf(), testing::HasSubstr("scene_gt.json"));
  fs::remove(split_ / "000003/scene_camera.json");
  EXPECT_THAT(messageOf(), testing::HasSubstr("scene_camera.json"));
  fs::remove_all(split_ / "000003");
  EXPECT_THAT(messageOf(), testing::HasSubstr("no scene folders"));
}

TEST_F(BopDataset, MissingImagesAreNamed) {
  fs::remove(split_ / "000003/depth/000005.png");
  EXPECT_THROW(loadBopFrame(readBopSplit(split_.string()).at(0)), std::runtime_error);
  fs::remove(split_ / "000003/rgb/000005.png");
  EXPECT_THAT(messageOf(), testing::HasSubstr("000005"));
}

TEST_F(BopDataset, LeavesOutWhatIsMissingAndCountsIt) {
  write("scene_camera.json",
        R"({"5": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1]}, "6": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1]},
                                 "7": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1]}})");
  cv::imwrite((split_ / "000003/rgb/000007.png").string(), cv::Mat(4, 6, CV_8UC3, cv::Scalar(1, 2, 3)));
  const BopSplit split = openBopSplit(split_.string());
  ASSERT_EQ(split.frames.size(), 1u);
  EXPECT_EQ(split.frames[0].frame, 5);
  ASSERT_EQ(split.missing.size(), 2u);
  EXPECT_THAT(split.missing[0], testing::HasSubstr("000003/000006: no colour image"));
  EXPECT_THAT(split.missing[1], testing::HasSubstr("000003/000007: no depth image"));
  EXPECT_THAT(describeMissing(split), testing::HasSubstr("000003/000007"));
}

TEST_F(BopDataset, GoesOnWithoutAScenesCameras) {
  fs::create_directories(split_ / "000004/rgb");
  const BopSplit split = openBopSplit(split_.string());
  EXPECT_EQ(split.frames.size(), 1u);
  EXPECT_THAT(split.missing, testing::ElementsAre("000004: no scene_camera.json"));
  EXPECT_THAT(refusal<std::runtime_error>([&] { openBopSplit((split_ / "000003").string()); }),
              testing::HasSubstr("is a scene itself; give the folder that holds it"));
}

TEST_F(BopDataset, ReadsIndustrialLayouts) {
  const fs::path scene = split_ / "000003";
  fs::remove_all(scene / "rgb");
  fs::remove_all(scene / "depth");
  for (const char* folder : {"gray_photoneo", "depth_photoneo"}) fs::create_directories(scene / folder);
  cv::imwrite((scene / "gray_photoneo/0005.tif").string(), cv::Mat(4, 6, CV_8UC1, cv::Scalar(9)));
  cv::imwrite((scene / "depth_photoneo/0005.tif").string(), cv::Mat(4, 6, CV_16UC1, cv::Scalar(12340)));
  for (const char* name : {"scene_camera", "scene_gt"})
    fs::rename(scene / (std::string(name) + ".json"), scene / (std::string(name) + "_photoneo.json"));
  const auto frames = readBopSplit(split_.string());
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].has_ground_truth);
  const RgbdFrame frame = loadBopFrame(frames[0]);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(2, 3), cv::Vec3b(9, 9, 9));
  EXPECT_NEAR(frame.depth.at<float>(2, 3), 1.234f, 1e-6f);

  write("scene_camera_cam1.json", "{}");
  EXPECT_THAT(messageOf(), testing::HasSubstr("cam1, photoneo"));
  EXPECT_EQ(openBopSplit(split_.string(), {"photoneo", false}).frames.size(), 1u);
}

TEST_F(BopDataset, HonoursTheTargetsOfATestSplit) {
  write("scene_camera.json",
        R"({"5": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1]}, "6": {"cam_K": [500, 0, 3, 0, 510, 2, 0, 0, 1]}})");
  for (const char* folder : {"rgb", "depth"})
    fs::copy(split_ / "000003" / folder / "000005.png", split_ / "000003" / folder / "000006.png");
  const fs::path root = fs::path(testing::TempDir()) / "bop_targets_test";
  fs::remove_all(root);
  fs::create_directories(root);
  fs::copy(split_, root / "test", fs::copy_options::recursive);
  const std::string split = (root / "test/").string();
  EXPECT_EQ(openBopSplit(split, {"", true}).frames.size(), 2u);
  std::ofstream(root / "test_targets_bop19.json") << R"([{"im_id": 6, "inst_count": 1, "obj_id": 9, "scene_id": 3}])";
  const BopSplit chosen = openBopSplit(split, {"", true});
  ASSERT_EQ(chosen.frames.size(), 1u);
  EXPECT_EQ(chosen.frames[0].frame, 6);
  EXPECT_FALSE(chosen.frames[0].has_ground_truth);
  EXPECT_THAT(chosen.targets_file, testing::HasSubstr("test_targets_bop19.json"));
  fs::remove(root / "test/000003/rgb/000005.png");
  EXPECT_TRUE(openBopSplit(split, {"", true}).missing.empty()) << "5 is no target";
  fs::copy(root / "test/000003/rgb/000006.png", root / "test/000003/rgb/000005.png");
  EXPECT_EQ(openBopSplit(split).frames.size(), 2u);
  std::ofstream(root / "test_targets_bop19.json") << "[{}]";
  EXPECT_THAT(refusal<std::runtime_error>([&] {
                openBopSplit(split, {"", true});
              }),
              testing::HasSubstr("test_targets_bop19.json: has no "));
}

TEST_F(BopDataset, ReadsImagesAsTheyAreStored) {
  const fs::path scene = split_ / "000003";
  write("camera.json", R"({"fx": 500, "fy": 510, "cx": 3, "cy": 2, "depth_scale": 0.1})");
  cv::Mat color(40, 60, CV_8UC3, cv::Scalar(0, 0, 0));
  color.colRange(30, 60).setTo(cv::Scalar(200, 200, 200));
  std::vector<uchar> jpeg;
  cv::imencode(".jpg", color, jpeg);
  // EXIF that says: rotate by 90 degrees.
  const std::string exif(
      "\xff\xe1\0\x22"
      "Exif\0\0"
      "MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
  const std::string file = (scene / "5.jpg").string();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
  ASSERT_EQ(cv::imread(file).size(), cv::Size(40, 60));  // OpenCV rotates it
  cv::imwrite((scene / "depth.png").string(), cv::Mat(40, 60, CV_16UC1, cv::Scalar(12340)));
  const RgbdFrame frame = loadFrameFiles(file, (scene / "depth.png").string(), (scene / "camera.json").string());
  EXPECT_EQ(frame.color.size(), cv::Size(60, 40));
  EXPECT_GT(frame.color.at<cv::Vec3b>(20, 50)[0], 150);
}

TEST_F(BopDataset, UndoesTheDistortionOfACameraFile) {
  const fs::path scene = split_ / "000003";
  cv::Mat color(480, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  cv::imwrite((scene / "c.png").string(), color);
  cv::imwrite((scene / "d.png").string(), cv::Mat(480, 640, CV_16UC1, cv::Scalar(1000)));
  const auto read = [&](const std::string& more) {
    write("camera.json", R"({"fx": 500, "fy": 500, "cx": 320, "cy": 240, )" + more + "}");
    return loadFrameFiles((scene / "c.png").string(), (scene / "d.png").string(), (scene / "camera.json").string());
  };
  EXPECT_FLOAT_EQ(read(R"("width": 640, "height": 480)").depth.at<float>(2, 2), 1.0f);
  // Barrel distortion makes the corners of the undistorted picture come from inside: nothing is missing there;
  // pincushion distortion leaves them empty.
  EXPECT_FLOAT_EQ(read(R"("D": [-0.2, 0, 0, 0])").depth.at<float>(2, 2), 1.0f);
  EXPECT_FLOAT_EQ(read(R"("D": [0.2, 0, 0, 0])").depth.at<float>(2, 2), 0.0f);
  EXPECT_THAT(refusal<std::runtime_error>([&] { read(R"("D": [0.2, 0, 0, 0], "distortion_model": "own")"); }),
              testing::HasSubstr("'own' is not known"));
  EXPECT_THAT(refusal<std::runtime_error>([&] { read(R"("width": 1280, "height": 960)"); }),
              testing::HasSubstr("camera of 1280x960 pixels, the colour image has 640x480"));
}

TEST_F(BopDataset, WrongLengthsAreRefused) {
  write("scene_camera.json", R"({"5": {"cam_K": [500, 0, 3], "depth_scale": 0.1}})");
  EXPECT_THAT(messageOf(), testing::HasSubstr("cam_K"));
}

}  // namespace
}  // namespace recognition
