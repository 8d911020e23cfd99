// Boards and parameter files.
#include "fuzz/fuzz.h"
#include "rgbd_recognition/recognizer.h"
#include "rgbd_recognition/training/fiducial_board.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  const std::string file = inputFile("input.yaml", data, size);
  mayRefuse([&] { FiducialBoard::fromYaml(file); });
  mayRefuse([&] { RecognizerParameters::fromYaml(file); });
  return 0;
}
