// Cameras as files describe them, and the JSON files of a BOP scene.
#include <opencv2/imgcodecs.hpp>

#include "evaluation/camera_file.h"
#include "fuzz/fuzz.h"
#include "core/frame_check.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace recognition;
  cv::imwrite(fuzzFolder() / "color_0.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 2, 3)));
  cv::imwrite(fuzzFolder() / "depth_0.png", cv::Mat(48, 64, CV_16UC1, cv::Scalar(900)));
  writeSeed("scene", R"({"0": {"cam_K": [500, 0, 320, 0, 500, 240, 0, 0, 1], "depth_scale": 0.1}})");
  writeSeed("nested", R"({"K": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "D": [0.1, 0, 0, 0]})");
  writeSeed("plain", R"({"fx": 500, "fy": 500, "cx": 320, "cy": 240})");
  writeSeed("truth",
            R"({"0": [{"obj_id": 9, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [10, -20, 900]}]})");
  writeSeed("numbers", "500 0 320\n0 500 240\n0 0 1\n");
  writeSeed("yaml", "image_width: 640\ncamera_matrix:\n  data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n");
  writeSeed("calibration", R"({"mtx": [[50, 0, 32], [0, 50, 24], [0, 0, 1]], "dist": [[-0.2, 0.1, 0, 0, 0]]})");
  writeSeed("fisheye",
            "K: [50, 0, 32, 0, 50, 24, 0, 0, 1]\nD: [0.1, 0, 0, 0]\ndistortion_model: equidistant\n"
            "P: [45, 0, 32, 0, 0, 45, 24, 0, 0, 0, 1, 0]\n");
  writeSeed("ini", "[image]\n\nwidth\n640\n\ncamera matrix\n500 0 320\n0 500 240\n0 0 1\n\ndistortion\n0 0 0 0 0\n");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  const std::string file = inputFile("camera", data, size);
  mayRefuse([&] { readCameraFile(file, 0); });
  const std::string color = fuzzFolder() / "color_0.png", depth = fuzzFolder() / "depth_0.png";
  mayRefuse([&] { requireFit(loadFrameFiles(color, depth, file)); });
  const std::filesystem::path scene = std::filesystem::path(fuzzFolder().string()) / "test/000001";
  for (const char* folder : {"rgb", "depth"}) {
    std::filesystem::create_directories(scene / folder);
    writeText((scene / folder / "0.png").string(), "");
  }
  const std::string good = R"({"0": {"cam_K": [500, 0, 320, 0, 500, 240, 0, 0, 1]}})", text(data, data + size);
  for (const bool is_camera : {true, false}) {
    writeText((scene / "scene_camera.json").string(), is_camera ? text : good);
    writeText((scene / "scene_gt.json").string(), is_camera ? "{}" : text);
    mayRefuse([&] { readBopSplit(scene.parent_path().string()); });
  }
  return 0;
}
