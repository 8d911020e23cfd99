#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "camera/openni2_modes.h"

namespace recognition {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string errorOf(const std::string& name) {
  return refusal([&] { parseStreamMode(name); });
}

TEST(StreamMode, HasNames) {
  EXPECT_EQ((StreamMode{1280, 1024, 15}), parseStreamMode("SXGA_15Hz"));
  EXPECT_EQ((StreamMode{640, 480, 30}), parseStreamMode("VGA_30Hz"));
  EXPECT_EQ((StreamMode{320, 240, 60}), parseStreamMode("QVGA_60Hz"));
  for (const char* name : {"SXGA_30Hz", "VGA_15Hz", "QVGA_30Hz", "1024x768_25Hz"}) {
    EXPECT_EQ(name, streamModeName(parseStreamMode(name)));
  }
}

TEST(StreamMode, RefusesOtherTextAndNamesIt) {
  for (const char* name :
       {"", "VGA", "VGA_", "VGA_30", "VGA_30Hz!", "XGA_30Hz", "VGA_0Hz", "VGA_-5Hz", "0x480_30Hz", "5"}) {
    EXPECT_THAT(errorOf(name), HasSubstr("'" + std::string(name) + "'"));
  }
}

TEST(StreamMode, TakesTheNearestRateOfTheSameSize) {
  const std::vector<StreamMode> kinect = {{640, 480, 30}, {1280, 1024, 10}};
  EXPECT_EQ((StreamMode{1280, 1024, 10}), closestStreamMode({1280, 1024, 30}, kinect));
  EXPECT_EQ((StreamMode{640, 480, 30}), closestStreamMode({640, 480, 15}, kinect));
  EXPECT_THAT(refusal([&] {
                closestStreamMode({320, 240, 30}, kinect);
              }),
              AllOf(HasSubstr("QVGA_30Hz"), HasSubstr("VGA_30Hz SXGA_10Hz")));
}

}  // namespace
}  // namespace recognition
