#include "matching/quantized_descriptors.h"

#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"
#include "matching/descriptor_index.h"

namespace recognition {
namespace {

class Kernels : public testing::TestWithParam<DotKernel> {};

TEST_P(Kernels, ScoresAreExact) {
  if (!kernelSupported(GetParam())) GTEST_SKIP() << "not on this processor";
  std::mt19937 random(1);
  for (const int length : {64, 128}) {
    cv::Mat descriptors = synthetic::randomDescriptors(16 * 13 - 5, length, random);
    descriptors.row(0).setTo(1.0f);   // limited to 127
    descriptors.row(1).setTo(-1.0f);  // limited to -127
    const QuantizedRows rows = quantize(descriptors);
    DescriptorBlocks blocks(length);
    blocks.resize(13);
    for (int i = 0; i < rows.count(); ++i) blocks.set(i, rows, i);
    BlockScores found;
    for (int q = 0; q < rows.count(); ++q) {
      const std::int32_t floor = -100 * q;
      scoreBlocks(blocks, 0, 13, rows, q, floor, &found, GetParam());
      for (int i = 0; i < rows.count(); ++i) {
        int dot = 0;
        for (int k = 0; k < length; ++k) dot += rows.row(q)[k] * rows.row(i)[k];
        ASSERT_EQ(found.scores[i], dot - rows.norms[i] / 2) << "query " << q << " row " << i;
      }
      for (int i = rows.count(); i < 16 * 13; ++i) EXPECT_LE(found.scores[i], kEmptyScore);
      for (int i = 0; i < 16 * 13; ++i)
        ASSERT_EQ((found.above[i / 16] >> (i % 16)) & 1, found.scores[i] > floor) << "query " << q << " row " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::Values(DotKernel::kPortable, DotKernel::kAvx2, DotKernel::kAvx512Vnni));

TEST(QuantizedDescriptors, DistancesWithinBound) {
  std::mt19937 random(2);
  for (const int length : {64, 128}) {
    const cv::Mat descriptors = synthetic::randomDescriptors(100, length, random);
    const cv::Mat near = synthetic::perturbed(descriptors, 0.4, random);
    const QuantizedRows rows = quantize(descriptors), queries = quantize(near);
    DescriptorBlocks blocks(length);
    blocks.resize(7);
    for (int i = 0; i < rows.count(); ++i) blocks.set(i, rows, i);
    BlockScores found;
    const double bound = 2.0 * std::sqrt(length) / (2.0 * kDescriptorScale);  // both descriptors move
    for (int q = 0; q < queries.count(); ++q) {
      scoreBlocks(blocks, 0, 7, queries, q, 0, &found);
      for (int i = 0; i < rows.count(); ++i)
        EXPECT_NEAR(distanceFromScore(queries.norms[q], found.scores[i]), cv::norm(near.row(q), descriptors.row(i)),
                    bound + 1e-4);
    }
  }
}

TEST(QuantizedDescriptors, FloorIsTheDistance) {
  for (const std::int32_t norm : {30000, 40001})
    for (const double distance : {0.0, 0.3, 1.0}) {
      const std::int32_t floor = scoreFloor(norm, distance);
      EXPECT_GE(distanceFromScore(norm, floor), distance - 1e-6);
      EXPECT_LE(distanceFromScore(norm, floor + 1), distance + 1e-6);
    }
}

TEST(QuantizedDescriptors, WrongTypesThrow) {
  EXPECT_THROW(quantize(cv::Mat(3, 128, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(quantize(cv::Mat(3, 63, CV_32FC1)), std::invalid_argument);
  EXPECT_EQ(quantize(cv::Mat()).count(), 0);
}

TEST(QuantizedDescriptors, ThoseOfAModelAreTakenAsTheyAre) {
  std::mt19937 random(6);
  const cv::Mat descriptors = synthetic::randomDescriptors(20, 64, random);
  const QuantizedRows of_units = quantize(descriptors), of_bytes = quantize(quantizedDescriptors(descriptors));
  EXPECT_EQ(of_bytes.values, of_units.values);
  EXPECT_EQ(of_bytes.norms, of_units.norms);
  EXPECT_EQ(of_bytes.offsets, of_units.offsets);
  const cv::Mat back = unitDescriptors(quantizedDescriptors(descriptors));
  for (int i = 0; i < back.rows; ++i) {
    EXPECT_NEAR(cv::norm(back.row(i)), 1.0, 1e-5);
    EXPECT_LT(cv::norm(back.row(i), descriptors.row(i)), 1.5 * std::sqrt(64.0) / (2.0 * kDescriptorScale));
  }
}

TEST(NearestRows, KeepsTheBest) {
  NearestRows nearest(3, 10);
  const std::vector<std::pair<int, std::uint32_t>> offers = {{11, 0}, {10, 1}, {50, 5}, {20, 3},
                                                             {9, 4},  {50, 2}, {30, 7}, {30, 6}};
  for (const auto& [score, row] : offers) nearest.offer(score, row);
  nearest.finish();
  std::vector<std::uint32_t> rows;
  for (const RankedRow row : nearest.rows()) rows.push_back(rowOf(row));
  EXPECT_EQ(rows, (std::vector<std::uint32_t>{2, 5, 6}));
  EXPECT_LT(nearest.floor(), 30);
  EXPECT_EQ(scoreOf(nearest.rows()[2]), 30);
}

TEST(NearestRows, ManyOffersInAnyOrderLeaveTheSame) {
  std::mt19937 random(7);
  std::vector<std::pair<int, std::uint32_t>> offers;
  for (std::uint32_t row = 0; row < 500; ++row) offers.emplace_back(static_cast<int>(random() % 100) - 50, row);
  const auto kept = [&offers] {
    NearestRows nearest(24, -40);
    for (const auto& [score, row] : offers) nearest.offer(score, row);
    nearest.finish();
    return nearest.rows();
  };
  auto sorted = offers;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  for (int turn = 0; turn < 3; ++turn) {
    const auto rows = kept();
    ASSERT_EQ(rows.size(), 24u);
    for (size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rowOf(rows[i]), sorted[i].second);
    std::shuffle(offers.begin(), offers.end(), random);
  }
}

TEST(DescriptorIndex, FindsWhatASimpleLoopFinds) {
  std::mt19937 random(3);
  const std::vector<cv::Mat> models = {synthetic::randomDescriptors(500, 128, random), cv::Mat(),
                                       synthetic::randomDescriptors(300, 128, random)};
  cv::Mat all;
  cv::vconcat(models[0], models[2], all);
  const DescriptorIndex index(models, 128);
  EXPECT_EQ(index.count(), 800);
  const cv::Mat near = synthetic::perturbed(all, 0.3, random);
  const QuantizedRows queries = quantize(near);
  const auto nearest = index.nearest(queries, 2, 2.0);
  for (int q = 0; q < near.rows; ++q) {
    ASSERT_EQ(nearest[q].rows().size(), 2u);
    EXPECT_EQ(rowOf(nearest[q].rows()[0]), static_cast<std::uint32_t>(q));
  }
}

TEST(DescriptorIndex, ClustersLoseLittle) {
  std::mt19937 random(4);
  const std::vector<cv::Mat> models(1, synthetic::randomDescriptors(4000, 128, random));
  IndexParameters clustered;
  clustered.exact_below = 100;
  clustered.rows_per_cluster = 64;
  clustered.probes = 16;
  const QuantizedRows queries = quantize(synthetic::perturbed(models[0].rowRange(0, 500), 0.3, random));
  const auto found = DescriptorIndex(models, 128, clustered).nearest(queries, 1, 2.0);
  int right = 0;
  for (int q = 0; q < queries.count(); ++q)
    right += !found[q].rows().empty() && rowOf(found[q].rows()[0]) == static_cast<std::uint32_t>(q);
  EXPECT_GE(right, 490);  // random descriptors have no clusters: the hardest case
}

TEST(DescriptorIndex, PassesOverRowsOfOtherSizes) {
  std::mt19937 random(5);
  const std::vector<cv::Mat> models(1, synthetic::randomDescriptors(640, 128, random));
  std::vector<float> sizes(640);
  for (size_t i = 0; i < sizes.size(); ++i) sizes[i] = i % 2 == 0 ? 0.01f : 0.1f;
  IndexParameters clustered;
  clustered.exact_below = 100;
  for (const IndexParameters& parameters : {IndexParameters(), clustered}) {
    const DescriptorIndex index(models, 128, parameters, {sizes});
    const QuantizedRows queries = quantize(models[0]);
    const auto found = index.nearest(queries, 5, 2.0, std::vector<SizeRange>(640, SizeRange{0.005f, 0.02f}));
    int others = 0, all = 0;
    for (int q = 0; q < queries.count(); q += 2) {
      ASSERT_FALSE(found[q].rows().empty());
      EXPECT_EQ(rowOf(found[q].rows()[0]), static_cast<std::uint32_t>(q));
      for (const RankedRow row : found[q].rows()) others += rowOf(row) % 2;
      all += static_cast<int>(found[q].rows().size());
    }
    EXPECT_LT(others, all / 3);  // only those that share a block of 16 rows
    const auto any = index.nearest(queries, 1, 2.0, std::vector<SizeRange>(640));
    EXPECT_EQ(rowOf(any[1].rows()[0]), 1u);
  }
}

}  // namespace
}  // namespace recognition
