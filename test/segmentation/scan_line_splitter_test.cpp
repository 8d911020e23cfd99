#include "segmentation/scan_line_splitter.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace recognition {
namespace {

constexpr double kPitch = 1.0 / 525.0;

/// z(i) for i in 0..n as the noise model wants it.
std::vector<float> lineOf(NoiseModel model, int n, const std::function<double(int)>& depth) {
  std::vector<float> z;
  for (int i = 0; i < n; ++i)
    z.push_back(static_cast<float>(model == NoiseModel::kConstant ? depth(i) : 1.0 / depth(i)));
  return z;
}

SegmentationParameters fineParameters(SegmentationMode mode, NoiseModel model) {
  SegmentationParameters parameters;
  parameters.mode = mode;
  parameters.noise_model = model;
  parameters.epsilon = 0.004;
  parameters.sigma = 0.001;
  parameters.lateral = 0.0;
  return parameters;
}

class EveryMode : public testing::TestWithParam<std::tuple<SegmentationMode, NoiseModel>> {
 protected:
  ScanLineSplitter splitter_{fineParameters(std::get<0>(GetParam()), std::get<1>(GetParam()))};
  NoiseModel model_ = std::get<1>(GetParam());

  void split(int n, const std::function<double(int)>& depth) {
    line_ = lineOf(model_, n, depth);
    splitter_.split(line_.data(), n, kPitch);
  }
  std::vector<float> line_;
};

INSTANTIATE_TEST_SUITE_P(Modes, EveryMode,
                         testing::Combine(testing::Values(SegmentationMode::kSimpleLinear,
                                                          SegmentationMode::kSimpleQuadratic, SegmentationMode::kLsAicc,
                                                          SegmentationMode::kLsMixed, SegmentationMode::kLsLinear,
                                                          SegmentationMode::kLsQuadratic),
                                          testing::Values(NoiseModel::kConstant, NoiseModel::kSensor)));

TEST_P(EveryMode, LeavesFlatSurfaceWhole) {
  split(200, [](int) { return 1.2; });
  ASSERT_EQ(splitter_.segments().size(), 1u);
  EXPECT_EQ(splitter_.segments()[0].size(), 200);
  EXPECT_TRUE(splitter_.edges().empty());
}

TEST_P(EveryMode, FindsJumpOnItsFartherSide) {
  split(120, [](int i) { return i < 50 ? 1.0 : 1.2; });
  ASSERT_EQ(splitter_.edges().size(), 1u);
  EXPECT_EQ(splitter_.edges()[0].index, 50);
  EXPECT_EQ(splitter_.edges()[0].type, EdgeType::kJump);
}

/// Within how many samples of `index` the nearest edge of that type is.
int distanceToEdge(const std::vector<EdgePoint>& edges, int index, EdgeType type) {
  int nearest = std::numeric_limits<int>::max();
  for (const EdgePoint& edge : edges)
    if (edge.type == type) nearest = std::min(nearest, std::abs(edge.index - index));
  return nearest;
}

TEST_P(EveryMode, TypesRoofAndValley) {
  split(81, [](int i) { return 1.0 + 0.003 * std::abs(i - 40); });
  EXPECT_LE(distanceToEdge(splitter_.edges(), 40, EdgeType::kConvexCrease), 2);
  EXPECT_EQ(distanceToEdge(splitter_.edges(), 40, EdgeType::kJump), std::numeric_limits<int>::max());
  split(81, [](int i) { return 1.2 - 0.003 * std::abs(i - 40); });
  EXPECT_LE(distanceToEdge(splitter_.edges(), 40, EdgeType::kConcaveCrease), 2);
}

TEST_P(EveryMode, SplitsAtInvalidSamples) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  line_ = lineOf(model_, 60, [](int) { return 1.0; });
  line_[0] = 0.0f;
  line_[20] = line_[21] = nan;
  line_[40] = -1.0f;
  line_[59] = 0.0f;
  splitter_.split(line_.data(), 60, kPitch);
  ASSERT_EQ(splitter_.segments().size(), 3u);
  EXPECT_EQ(splitter_.segments()[0].first, 1);
  EXPECT_EQ(splitter_.segments()[0].last, 19);
  EXPECT_EQ(splitter_.segments()[1].first, 22);
  EXPECT_EQ(splitter_.segments()[2].last, 58);
  EXPECT_TRUE(splitter_.edges().empty());
}

TEST_P(EveryMode, SegmentsCoverAllValidSamplesInOrder) {
  split(300, [](int i) { return 1.0 + 0.1 * std::sin(0.05 * i) + (i % 97 == 0 ? 0.2 : 0.0) + (i > 150 ? 0.05 : 0.0); });
  int next = 0;
  for (const SubSegment& segment : splitter_.segments()) {
    EXPECT_TRUE(segment.first == next || segment.first == next - 1) << segment.first;  // a crease is shared
    EXPECT_GE(segment.last, segment.first);
    next = segment.last + 1;
  }
  EXPECT_EQ(next, 300);
}

TEST_P(EveryMode, BearsShortAndEmptyLines) {
  split(0, [](int) { return 1.0; });
  EXPECT_TRUE(splitter_.segments().empty());
  split(1, [](int) { return 1.0; });
  EXPECT_EQ(splitter_.segments().size(), 1u);
  splitter_.split(std::vector<float>(5, 0.0f).data(), 5, kPitch);
  EXPECT_TRUE(splitter_.segments().empty());
}

TEST(ScanLineSplitter, QuadraticKeepsParabolaThatLinearSplits) {
  const auto bowl = [](int i) { return 1.0 + 2e-5 * (i - 60) * (i - 60); };
  const std::vector<float> z = lineOf(NoiseModel::kConstant, 121, bowl);
  ScanLineSplitter quadratic(fineParameters(SegmentationMode::kSimpleQuadratic, NoiseModel::kConstant));
  quadratic.split(z.data(), 121, kPitch);
  EXPECT_EQ(quadratic.segments().size(), 1u);
  ScanLineSplitter linear(fineParameters(SegmentationMode::kSimpleLinear, NoiseModel::kConstant));
  linear.split(z.data(), 121, kPitch);
  EXPECT_GT(linear.segments().size(), 2u);
}

TEST(ScanLineSplitter, MixedModeChangesStrategyBelowSwitchLength) {
  // A crease too faint for epsilon but not for AICc.
  const auto faint = [](int i) { return 1.0 + 0.0004 * std::abs(i - 20); };
  SegmentationParameters parameters = fineParameters(SegmentationMode::kLsMixed, NoiseModel::kConstant);
  const std::vector<float> z = lineOf(NoiseModel::kConstant, 41, faint);
  ScanLineSplitter below(parameters);  // 41 < 4 * 12
  below.split(z.data(), 41, kPitch);
  EXPECT_EQ(below.segments().size(), 2u);
  parameters.f_mixed = 10;
  ScanLineSplitter above(parameters);
  above.split(z.data(), 41, kPitch);
  EXPECT_EQ(above.segments().size(), 1u);
}

TEST(ScanLineSplitter, ThresholdsFollowTheRangeOnlyWithTheSensorModel) {
  const auto step = [](double range) { return [range](int i) { return i < 40 ? range : range + 0.02; }; };
  for (const NoiseModel model : {NoiseModel::kConstant, NoiseModel::kSensor}) {
    ScanLineSplitter splitter(fineParameters(SegmentationMode::kSimpleQuadratic, model));
    const std::vector<float> near = lineOf(model, 80, step(0.8)), far = lineOf(model, 80, step(3.0));
    splitter.split(near.data(), 80, kPitch);
    EXPECT_GT(splitter.segments().size(), 1u);
    splitter.split(far.data(), 80, kPitch);
    EXPECT_EQ(splitter.segments().size() > 1, model == NoiseModel::kConstant);
  }
}

}  // namespace
}  // namespace recognition
