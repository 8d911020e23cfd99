#include "matching/consistency_graph.h"

#include <gmock/gmock.h>

#include "matching/synthetic_scene.h"

namespace recognition {
namespace {

CorrespondenceSet toSet(const synthetic::Problem& problem) {
  return {problem.pairs, problem.scene_points, problem.model_points};
}

TEST(ConsistencyGraph, RowsAreTheConsistentOnes) {
  std::mt19937 random(1);
  const CorrespondenceSet set = toSet(synthetic::makeProblem(150, 0.6, 0.002, random));
  ConsistencyGraph graph;
  for (const double epsilon : {0.01, 0.05}) {
    graph.reset(set, {epsilon});
    for (const int fixed : {0, 70, 149}) {
      std::vector<int> expected, found;
      set.findConsistent(fixed, {epsilon}, expected);
      forEachBit(graph.row(fixed), graph.words(), [&](int i) { found.push_back(i); });
      EXPECT_EQ(found, expected);
      EXPECT_EQ(countBits(graph.row(fixed), graph.words()), static_cast<int>(expected.size()));
      for (const int i : expected) EXPECT_TRUE(graph.agree(fixed, i) && graph.agree(i, fixed));
    }
  }
}

TEST(ConsistencyGraph, ACliqueIsKeptWhateverSurroundsIt) {
  std::mt19937 random(2);
  const auto problem = synthetic::makeProblem(300, 0.9, 0.001, random);
  const CorrespondenceSet set = toSet(problem);
  ConsistencyGraph graph;
  graph.reset(set, {0.01});
  for (int i = 0; i < set.size(); ++i) {
    if (set.pair(i).scene_feature >= problem.inliers) continue;
    EXPECT_TRUE(graph.mayHoldClique(graph.row(i), problem.inliers - 1));
  }
}

TEST(ConsistencyGraph, WithoutACliqueNothingIsLeft) {
  std::mt19937 random(3);
  const CorrespondenceSet set = toSet(synthetic::makeProblem(300, 1.0, 0.0, random));
  ConsistencyGraph graph;
  graph.reset(set, {0.01});
  int crowded = 0;
  for (int i = 0; i < set.size(); ++i) {
    crowded += countBits(graph.row(i), graph.words()) > 5;
    EXPECT_FALSE(graph.mayHoldClique(graph.row(i), 5));
  }
  EXPECT_GT(crowded, 20);  // by their number alone they could have held one
  EXPECT_GT(graph.takeWork(), 0);
  EXPECT_EQ(graph.takeWork(), 0);
}

TEST(TurnTogether, OneTurnExplainsARigidSetAndNotAScatteredRing) {
  std::mt19937 random(4);
  UniqueFeatures unique;
  const auto rigid = synthetic::makeProblem(20, 0.0, 0.001, random);
  const CorrespondenceSet set = toSet(rigid);
  EXPECT_TRUE(set.rotateTogether(set.places(0), set.places(1), 0.015f, 15, unique));
  EXPECT_FALSE(set.rotateTogether(set.places(0), set.places(1), 0.015f, 20, unique));  // no more than there are

  synthetic::Problem ring;  // equally far from both fixed points, each turned by another angle
  for (int i = 0; i < 40; ++i) {
    const float angle = 0.157f * static_cast<float>(i);
    ring.model_points.push_back({0.1f, 0.0f, 0.0f});
    ring.scene_points.push_back({0.1f * std::cos(angle), 0.1f * std::sin(angle), 1.0f});
    ring.pairs.push_back({i, i, 0.1f});
  }
  const FeaturePlaces first{{0, 0, 0.9f}, {0, 0, -0.1f}}, second{{0, 0, 1.1f}, {0, 0, 0.1f}};
  EXPECT_TRUE(toSet(ring).rotateTogether(first, second, 0.02f, 2, unique));
  EXPECT_FALSE(toSet(ring).rotateTogether(first, second, 0.02f, 3, unique));
}

TEST(TurnTogether, OneSceneFeatureCountsOnce) {
  std::mt19937 random(5);
  auto problem = synthetic::makeProblem(10, 0.0, 0.0, random);
  const auto once = problem.pairs;
  problem.pairs.insert(problem.pairs.end(), once.begin(), once.end());
  const CorrespondenceSet set = toSet(problem);
  UniqueFeatures unique;
  EXPECT_TRUE(set.rotateTogether(set.places(0), set.places(1), 0.015f, 9, unique));
  EXPECT_FALSE(set.rotateTogether(set.places(0), set.places(1), 0.015f, 10, unique));
}

}  // namespace
}  // namespace recognition
