#include <sstream>

#include "fuzz/fuzz.h"
#include "evaluation/result_files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  using namespace recognition;
  std::istringstream in(std::string(data, data + size));
  mayRefuse([&] { readChallengeCsv(in); });
  return 0;
}
