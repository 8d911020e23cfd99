#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "model/temporary_directory.h"
#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {
namespace {

const std::string kBoards = std::string(RGBD_SOURCE_DIR) + "/config/boards/";

int print(const std::string& arguments) {
  return std::system((std::string(RGBD_PRINT_BOARD) + " " + arguments + " > /dev/null 2>&1").c_str());
}

// Rendered by another program at 100 pixels an inch, the print must be the board at that scale.
TEST(PrintBoard, IsOfTrueSize) {
  const TemporaryDirectory directory;
  constexpr double kPixelsPerMetre = 100.0 / 0.0254;
  for (const std::string name : {"charuco", "aruco", "two_checkerboards"}) {
    ASSERT_EQ(print("--board " + kBoards + name + ".yaml --out " + (directory / "board.pdf")), 0);
    ASSERT_EQ(std::system(
                  ("pdftoppm -r 100 -gray -png -singlefile " + (directory / "board.pdf") + " " + (directory / "board"))
                      .c_str()),
              0);
    const cv::Mat page = cv::imread(directory / "board.png", cv::IMREAD_GRAYSCALE);
    const FiducialBoard board = FiducialBoard::fromYaml(kBoards + name + ".yaml");
    const cv::Mat expected = board.draw(kPixelsPerMetre);
    ASSERT_GE(page.cols, expected.cols);
    const int margin = (page.cols - expected.cols) / 2;
    EXPECT_NEAR(page.cols, (board.size().x() + 0.024) * kPixelsPerMetre, 2.0);
    EXPECT_NEAR(page.rows, (board.size().y() + 0.024) * kPixelsPerMetre, 2.0);
    const cv::Mat print = page(cv::Rect({margin, margin}, expected.size()));
    EXPECT_LT(cv::mean(cv::abs(print - expected))[0], 6.0) << name;  // rims of the squares, half a pixel off
    // Seen straight on by a camera at 1 m whose pixels are the print's.
    const CameraModel camera{page.cols, page.rows, kPixelsPerMetre, kPixelsPerMetre, 0.5 * page.cols, 0.5 * page.rows};
    const auto seen = detectBoard(board, page, camera);
    ASSERT_TRUE(seen) << name;
    EXPECT_NEAR(seen->camera_from_board.translation().z(), 1.0, 0.002) << name;
  }
}

TEST(PrintBoard, IsCutIntoPagesOfThePrinter) {
  const TemporaryDirectory directory;
  ASSERT_EQ(print("--board " + kBoards + "charuco.yaml --paper a4 --out " + (directory / "board.pdf")), 0);
  std::ostringstream text;
  text << std::ifstream(directory / "board.pdf", std::ios::binary).rdbuf();
  int pages = 0;
  for (size_t at = text.str().find("/MediaBox"); at != std::string::npos; at = text.str().find("/MediaBox", at + 1))
    ++pages;
  EXPECT_GE(pages, 6) << "0.5 m x 0.5 m on 0.186 m x 0.273 m";
}

TEST(PrintBoard, SaysWhatIsWrong) {
  const TemporaryDirectory directory;
  EXPECT_NE(print("--board /nowhere.yaml --out " + (directory / "board.pdf")), 0);
  EXPECT_NE(print("--board " + kBoards + "charuco.yaml --paper a9 --out " + (directory / "board.pdf")), 0);
  EXPECT_NE(print("--board " + kBoards + "charuco.yaml --out " + (directory / "no/folder/board.pdf")), 0);
}

}  // namespace
}  // namespace recognition
