#include "evaluation/camera_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/temporary_directory.h"
#include "refusal.h"

namespace recognition {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CameraFiles : public testing::Test {
 protected:
  CameraFile read(const std::string& text, std::optional<int> frame = std::nullopt) {
    writeText(directory_ / "camera", text);
    return readCameraFile(directory_ / "camera", frame);
  }

  void expectRead(const std::string& text, std::optional<int> frame = std::nullopt) {
    const CameraModel camera = read(text, frame).camera;
    EXPECT_DOUBLE_EQ(camera.fx, 1066.5) << text;
    EXPECT_DOUBLE_EQ(camera.fy, 1067.25) << text;
    EXPECT_DOUBLE_EQ(camera.cx, 312.5) << text;
    EXPECT_DOUBLE_EQ(camera.cy, 241.75) << text;
  }

  std::string reason(const std::string& text, std::optional<int> frame = std::nullopt) {
    return refusal<std::runtime_error>([&] { read(text, frame); });
  }

  TemporaryDirectory directory_;
};

TEST_F(CameraFiles, OfEveryKind) {
  expectRead(R"({"cam_K": [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1], "depth_scale": 0.1})");
  expectRead(
      R"({"cx": 312.5, "cy": 241.75, "fx": 1066.5, "fy": 1067.25, "depth_scale": 1.0, "width": 640, "height": 480})");
  expectRead(R"({"width": 640, "height": 480, "ppx": 312.5, "ppy": 241.75, "fx": 1066.5, "fy": 1067.25})");
  expectRead(R"({"K": [[1066.5, 0, 312.5], [0, 1067.25, 241.75], [0, 0, 1]], "resolution": [480, 640]})");
  expectRead(R"({"intrinsic_matrix": [1066.5, 0, 0, 0, 1067.25, 0, 312.5, 241.75, 1], "width": 640, "height": 480})");
  expectRead("1066.5 0 312.5\n0 1067.25 241.75\n0 0 1\n");
  expectRead("[1066.5, 0, 312.5; 0, 1067.25, 241.75; 0, 0, 1]");
  expectRead("fx: 1066.5\nfy: 1067.25\ncx: 312.5\ncy: 241.75\n");
  expectRead(
      "%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  data: [1066.5, 0., 312.5, 0., "
      "1067.25, 241.75, 0., 0., 1.]\n");
  EXPECT_DOUBLE_EQ(read(R"({"cam_K": [1, 0, 0, 0, 1, 0, 0, 0, 1], "depth_scale": 0.1})").depth_scale, 0.1);
}

TEST_F(CameraFiles, TakesTheEntryOfTheFrame) {
  const std::string scene =
      R"({"0": {"cam_K": [9, 0, 9, 0, 9, 9, 0, 0, 1]}, "12": {"cam_K": [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1]}})";
  expectRead(scene, 12);
  EXPECT_THAT(reason(scene, 7), HasSubstr("has no entry for frame 7, but for 0, 12"));
  EXPECT_THAT(reason(scene), HasSubstr("the image's name has no number"));
  expectRead(R"({"5": {"cam_K": [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1]}})", 12);  // the only one
}

TEST_F(CameraFiles, OfRosWithItsDistortion) {
  const std::string yaml =
      "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1]\ndistortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.28, 0.09, 0.001, 0.002, 0]\nprojection_matrix:\n"
      "  rows: 3\n  cols: 4\n  data: [1000, 0, 320, 0, 0, 1001, 240, 0, 0, 0, 1, 0]\n";
  const std::string ini =
      "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[narrow_stereo]\n\ncamera matrix\n"
      "1066.5 0.0 312.5\n0.0 1067.25 241.75\n0.0 0.0 1.0\n\ndistortion\n-0.28 0.09 0.001 0.002 0.0\n\nrectification\n"
      "1 0 0\n0 1 0\n0 0 1\n\nprojection\n1000 0 320 0\n0 1001 240 0\n0 0 1 0\n";
  for (const std::string& text : {yaml, ini}) {
    expectRead(text);
    const CameraFile file = read(text);
    EXPECT_EQ(file.camera.width, 640);
    EXPECT_EQ(file.camera.height, 480);
    EXPECT_EQ(file.distortion.model, "plumb_bob");
    EXPECT_THAT(file.distortion.coefficients, ElementsAre(-0.28, 0.09, 0.001, 0.002, 0.0));
    ASSERT_TRUE(file.rectified);
    EXPECT_DOUBLE_EQ(file.rectified->fy, 1001.0);
    EXPECT_DOUBLE_EQ(file.rectified->cx, 320.0);
  }
}

TEST_F(CameraFiles, HaveTheirDistortionUnderAnyUsualName) {
  const std::string matrix = "[[1066.5, 0, 312.5], [0, 1067.25, 241.75], [0, 0, 1]]";
  for (const std::string& text : std::vector<std::string>{
           R"({"mtx": )" + matrix + R"(, "dist": [[-0.28, 0.09, 0.001, 0.002, 0]]})",
           R"({"cameraMatrix": )" + matrix + R"(, "distCoeffs": [-0.28, 0.09, 0.001, 0.002, 0]})",
           R"({"K": )" + matrix + R"(, "D": [[-0.28], [0.09], [0.001], [0.002], [0]]})",
           "\xef\xbb\xbf{\"K\": " + matrix + R"(, "coeffs": [-0.28, 0.09, 0.001, 0.002, 0]})",
           R"({"camera_matrix": {"rows": 3, "data": [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1]},
            "distortion_coefficients": {"rows": 1, "data": [-0.28, 0.09, 0.001, 0.002, 0]}})",
           R"({"K": [[1066.5, 0, 312.5, 0], [0, 1067.25, 241.75, 0], [0, 0, 1, 0]],
            "model": "distortion.brown_conrady", "coeffs": [-0.28, 0.09, 0.001, 0.002, 0]})",
           R"({"intrinsics": {"fx": 1066.5, "fy": 1067.25, "cx": 312.5, "cy": 241.75},
            "D": [-0.28, 0.09, 0.001, 0.002, 0]})",
           "Camera_Matrix: !!opencv-matrix\n  data: [1066.5, 0, 312.5, 0, 1067.25, 241.75, 0, 0, 1]\n"
           "Distortion_Coefficients: !!opencv-matrix\n  data: [-0.28, 0.09, 0.001, 0.002, 0]\n",
           "camera_matrix: " + matrix + "\ndist_coeffs: [-0.28, 0.09, 0.001, 0.002, 0]\n",
           "K: " + matrix + "\nD: [-0.28, 0.09, 0.001, 0.002, 0]\n---\n"}) {
    expectRead(text);
    EXPECT_THAT(read(text).distortion.coefficients, ElementsAre(-0.28, 0.09, 0.001, 0.002, 0.0)) << text;
    EXPECT_EQ(read(text).distortion.model, "plumb_bob") << text;
  }
}

TEST_F(CameraFiles, SaysInItsOwnWordsWhatIsWrong) {
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"{\n\"cam_K\": [1,\n}", "no valid JSON in line 3"},
           {R"({"cam_K": [1, 2]})", "cam_K has 2 numbers, not 9"},
           {R"({"cam_K": "no"})", "cam_K holds what is no number"},
           {R"({"height": 480})", "holds no camera"},
           {R"({"fx": 500, "fy": 500, "cx": 320})", "has no cy"},
           {R"({"cam_K": [0, 0, 0, 0, 0, 0, 0, 0, 1]})", "no focal lengths above 0"},
           {R"({"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": 0})", "depth_scale is not above 0"},
           {"", "is empty"},
           {"hello", "holds no camera"},
           {"a: [1, 2", "no camera as JSON, yaml, ini or nine numbers"}}) {
    EXPECT_THAT(reason(text), testing::AllOf(HasSubstr(words), HasSubstr(directory_ / "camera"))) << text;
    EXPECT_THAT(reason(text), testing::Not(HasSubstr("json.exception")));
  }
  EXPECT_THAT(refusal<std::runtime_error>([&] { readCameraFile(directory_ / "none", std::nullopt); }),
              HasSubstr("none"));
}

}  // namespace
}  // namespace recognition
