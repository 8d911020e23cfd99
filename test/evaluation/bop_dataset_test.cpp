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

TEST_F(BopDataset, WrongLengthsAreRefused) {
  write("scene_camera.json", R"({"5": {"cam_K": [500, 0, 3], "depth_scale": 0.1}})");
  EXPECT_THAT(messageOf(), testing::HasSubstr("cam_K"));
}

}  // namespace
}  // namespace recognition
