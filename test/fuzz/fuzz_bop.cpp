// What lies beside the images of a BOP data set: truth, its information, targets, the names of the models; the first
// byte chooses which. Cameras: fuzz_camera.
#include <iterator>

#include "fuzz/fuzz.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {
namespace {

namespace fs = std::filesystem;

const char* const kFiles[] = {"test/000001/scene_gt.json", "test/000001/scene_gt_info.json", "test_targets_bop19.json",
                              "models/models_info.json"};
const std::string kTruth =
    R"({"0": [{"obj_id": 9, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [10, -20, 900]}]})";
const std::string kInfo = R"({"0": [{"visib_fract": 0.5}]})";
const std::string kTargets = R"([{"im_id": 0, "inst_count": 1, "obj_id": 9, "scene_id": 1}])";
const std::string kNames = R"({"1": {"name": "tea box", "diameter": 9}, "2": {"name": "tea box"}})";

fs::path root() { return fs::path(fuzzFolder().string()) / "set"; }

}  // namespace
}  // namespace recognition

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace recognition;
  writeSeed("truth", '\0' + kTruth);
  writeSeed("info", '\1' + kInfo);
  writeSeed("targets", '\2' + kTargets);
  writeSeed("names", '\3' + kNames);
  for (const char* folder : {"test/000001/rgb", "test/000001/depth", "models"}) fs::create_directories(root() / folder);
  for (const char* file : {"test/000001/rgb/0.png", "test/000001/depth/0.png", "models/obj_1.ply", "models/obj_2.ply"})
    writeText((root() / file).string(), "");
  writeText((root() / "test/000001/scene_camera.json").string(),
            R"({"0": {"cam_K": [500, 0, 320, 0, 500, 240, 0, 0, 1]}})");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  if (size == 0) return 0;
  const size_t chosen = data[0] % std::size(kFiles);
  const std::string* const good[] = {&kTruth, &kInfo, &kTargets, &kNames};
  for (size_t i = 0; i < std::size(kFiles); ++i)
    writeText((root() / kFiles[i]).string(), i == chosen ? std::string(data + 1, data + size) : *good[i]);
  if (chosen == 3)
    mayRefuse([&] { listBopModels((root() / "models").string()); });
  else
    mayRefuse([&] { openBopSplit((root() / "test").string(), {"", true}); });
  return 0;
}
