#include "training/view_overlap.h"

#include <cmath>

#include <gmock/gmock.h>

namespace recognition {
namespace {

TEST(MissingViews, AreToldWithTheirPlaces) {
  const auto at = [](std::initializer_list<double> angles) {
    std::vector<Eigen::Vector3f> directions = {{0.0f, 0.0f, 1.0f}};  // one from above, which has no angle
    for (const double angle : angles)
      directions.push_back(Eigen::Vector3f(std::cos(angle * M_PI / 180.0), std::sin(angle * M_PI / 180.0), 0.7f));
    return missingViews(directions);
  };
  EXPECT_EQ(at({0, 40, 80, 120, 160, 200, 240, 280, 320}), "");
  EXPECT_THAT(at({0, 40, 80, 120, 160, 200, 240, 280}),
              testing::HasSubstr("2 more are needed, 2 between 280 and 0 degrees"));
  EXPECT_THAT(at({350, 30, 130, 170, 210, 250, 290, 330}),
              testing::StartsWith("9 views overlap too little: 3 more are needed, 3 between 30 and 130 degrees"));
}

}  // namespace
}  // namespace recognition
