#include "verification/confidence.h"

#include <random>

#include <gtest/gtest.h>

namespace recognition {
namespace {

class Confidence : public ::testing::TestWithParam<HypothesisSource> {};

TEST_P(Confidence, NoAppearanceExceedsTheLargest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0), lab(0.0, 50.0);
  for (int i = 0; i < 1000; ++i) {
    Evidence evidence;
    evidence.inliers = static_cast<int>(30.0 * share(random));
    evidence.segment_share = share(random);
    const double most = maxConfidence(evidence, GetParam());
    evidence.structure = 2.0 * share(random) - 1.0;
    evidence.texture = share(random);
    evidence.depth_fit = share(random);
    evidence.color_distance = lab(random);
    evidence.illumination_change = lab(random);
    EXPECT_LE(confidence(evidence, GetParam()), most);
  }
}

TEST_P(Confidence, MoreOfTheSegmentIsMore) {
  Evidence little, much;
  little.inliers = much.inliers = 8;
  little.segment_share = 0.1;
  much.segment_share = 0.9;
  EXPECT_LT(maxConfidence(little, GetParam()), maxConfidence(much, GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Sources, Confidence,
                         ::testing::Values(HypothesisSource::kConsensus, HypothesisSource::kCorrespondence,
                                           HypothesisSource::kShape, HypothesisSource::kAlternative));

}  // namespace
}  // namespace recognition
