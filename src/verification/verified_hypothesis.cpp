#include "rgbd_recognition/verification/verified_hypothesis.h"

#include <array>

namespace recognition {

const char* rejectionName(Rejection rejection) {
  static constexpr std::array<const char*, 14> kNames = {
      "none",      "explained", "budget", "probe",      "out_of_view", "too_little_seen", "free_space",
      "consensus", "bound",     "coarse", "indistinct", "consistency", "conflict",        "duplicate"};
  return kNames.at(static_cast<size_t>(rejection));
}

const char* testLevelName(TestLevel level) {
  static constexpr std::array<const char*, kTestLevels> kNames = {"proposed", "probed",      "refined",
                                                                  "coarse",   "reprojected", "compared"};
  return kNames.at(static_cast<size_t>(level));
}

}  // namespace recognition
