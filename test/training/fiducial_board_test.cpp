#include "rgbd_recognition/training/fiducial_board.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/temporary_directory.h"
#include "training/turntable.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

using testing::HasSubstr;

FiducialBoard shipped(const std::string& name) {
  return FiducialBoard::fromYaml(std::string(RGBD_SOURCE_DIR) + "/config/boards/" + name + ".yaml");
}

class ShippedBoard : public testing::TestWithParam<const char*> {};

TEST_P(ShippedBoard, IsFoundWhereItIs) {
  const FiducialBoard board = shipped(GetParam());
  const TexturedMesh box = boxMesh({0.06f, 0.1f, 0.08f}, blobTexture(512, 5));
  const Turntable turntable(board, box, Pose(Eigen::Translation3d(0, 0, 0.04)));
  const bool markers = !board.markers().empty();  // a single small checkerboard in view fixes the tilt less well
  int found = 0;
  for (int i = 0; i < 8; ++i) {
    const Pose truth = orbitPose(45.0 * i + 3.0, 40.0, 0.9, {0, 0, 0});
    const RgbdFrame frame = turntable.view(truth, static_cast<std::uint64_t>(i));
    const auto seen = detectBoard(board, toGray(frame.color, frame.color_order), frame.color_camera);
    if (!seen) continue;
    ++found;
    EXPECT_LT(translationDistance(seen->camera_from_board, truth), markers ? 0.004 : 0.008) << i;
    EXPECT_LT(rotationDistance(seen->camera_from_board, truth), markers ? 0.01 : 0.03) << i;
    EXPECT_LT(seen->rms, 0.7) << i;
  }
  EXPECT_GE(found, markers ? 8 : 4);
}

INSTANTIATE_TEST_SUITE_P(Boards, ShippedBoard,
                         testing::Values("charuco", "aruco", "two_checkerboards", "checkerboard"));

TEST(FiducialBoard, IsNotFoundInOtherImages) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 256);
  for (const char* name : {"charuco", "two_checkerboards"}) {
    EXPECT_FALSE(detectBoard(shipped(name), noise, {640, 480, 525, 525, 319.5, 239.5}));
    EXPECT_FALSE(
        detectBoard(shipped(name), cv::Mat(480, 640, CV_8UC1, cv::Scalar(0)), {640, 480, 525, 525, 319.5, 239.5}));
  }
}

std::string reasonFor(const std::string& text) {
  const TemporaryDirectory directory;
  writeText(directory / "board.yaml", text);
  try {
    FiducialBoard::fromYaml(directory / "board.yaml");
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("board.yaml"));
    return error.what();
  }
  return "read";
}

TEST(FiducialBoard, SaysWhatIsWrong) {
  const std::string start =
      "{type: charuco, width: 0.5, height: 0.5, columns: 8, rows: 6, square: 0.04, marker: 0.03, dictionary: ";
  EXPECT_EQ(reasonFor(start + "5x5_100}"), "read");
  EXPECT_THAT(reasonFor(start + "7x7}"), HasSubstr("7x7"));
  EXPECT_THAT(reasonFor("{type: disc}"), HasSubstr("width"));
  EXPECT_THAT(reasonFor("{type: disc, width: 0.5, height: 0.5}"), HasSubstr("disc"));
  EXPECT_THAT(reasonFor("{type: charuco, width: -1, height: 0.5}"), HasSubstr("-1"));
  EXPECT_THAT(
      reasonFor(
          "{type: aruco, width: 0.5, height: 0.5, columns: 30, rows: 30, marker: 0.01, gap: 0.01, dictionary: 4x4_50}"),
      HasSubstr("more markers"));
  EXPECT_THAT(reasonFor("{type: checkerboards, width: 0.5, height: 0.5, checkerboards: [{columns: 7, rows: 5, square: "
                        "0.03, upper_left: [0, 0]}]}"),
              HasSubstr("upside down"));
  EXPECT_NE(reasonFor("["), "read");
  EXPECT_THROW(FiducialBoard::fromYaml("/nowhere.yaml"), std::invalid_argument);
}

}  // namespace
}  // namespace recognition
