#include "verification/confidence.h"

#include <functional>
#include <initializer_list>
#include <random>

#include <gtest/gtest.h>

namespace recognition {
namespace {

class Confidence : public ::testing::TestWithParam<HypothesisSource> {};

TEST_P(Confidence, NoAppearanceExceedsTheLargest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0), lab(0.0, 50.0);
  for (int i = 0; i < 1000; ++i) {
    VerifiedHypothesis hypothesis;
    hypothesis.hypothesis.source = GetParam();
    hypothesis.level = TestLevel::kRefined;
    Evidence& evidence = hypothesis.evidence;
    evidence.inliers = static_cast<int>(30.0 * share(random));
    const double bound = maxConfidence(hypothesis);
    evidence.peak = share(random) - 0.5;
    evidence.significance = 20.0 * share(random);
    evidence.segment_share = share(random);
    evidence.structure = 2.0 * share(random) - 1.0;
    evidence.depth_fit = share(random);
    evidence.color_distance = 4.0 + lab(random);
    evidence.illumination_change = lab(random);
    EXPECT_LE(confidence(evidence, GetParam()), bound);
  }
}

TEST_P(Confidence, NoEvidenceForCountsAgainst) {
  Evidence before;
  before.inliers = 8;
  before.significance = 2.0;
  before.structure = before.depth_fit = before.segment_share = 0.5;
  before.peak = 0.1;
  before.color_distance = before.illumination_change = 10.0;
  const double confidence_before = confidence(before, GetParam());
  for (const auto& better : std::initializer_list<std::function<void(Evidence*)>>{
           [](Evidence* e) { e->inliers = 9; }, [](Evidence* e) { e->significance = 3.0; },
           [](Evidence* e) { e->structure = 0.6; }, [](Evidence* e) { e->peak = 0.2; },
           [](Evidence* e) { e->color_distance = 8.0; }, [](Evidence* e) { e->depth_fit = 0.6; },
           [](Evidence* e) { e->segment_share = 0.6; }, [](Evidence* e) { e->illumination_change = 8.0; }}) {
    Evidence after = before;
    better(&after);
    EXPECT_GE(confidence(after, GetParam()), confidence_before);
  }
}

/// A consensus of many features on a surface of the right depth is right, whatever its segments; a blank plane that one
/// feature proposes is not, however well its depth fits.
TEST(Decision, ManyFeaturesAreBelievedAndBlankPlanesAreNot) {
  Evidence shelf_book;  // as measured on a real shelf, where segments run into each other
  shelf_book.inliers = 28;
  shelf_book.structure = 0.36;
  shelf_book.peak = 0.23;
  shelf_book.color_distance = 10.0;
  shelf_book.depth_fit = 0.98;
  shelf_book.segment_share = 0.73;
  EXPECT_GT(confidence(shelf_book, HypothesisSource::kConsensus), 0.9);
  Evidence merged = shelf_book;
  merged.segment_share = 0.2;
  EXPECT_GT(confidence(merged, HypothesisSource::kConsensus), 0.5);
  Evidence plane;  // a white board behind a white carton
  plane.inliers = 60;
  plane.structure = 0.5;
  plane.peak = 0.0;
  plane.color_distance = 8.0;
  plane.depth_fit = 1.0;
  plane.segment_share = 0.7;
  EXPECT_LT(confidence(plane, HypothesisSource::kCorrespondence), 0.3);
  EXPECT_LT(confidence(plane, HypothesisSource::kShape), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Sources, Confidence,
                         ::testing::Values(HypothesisSource::kConsensus, HypothesisSource::kCorrespondence,
                                           HypothesisSource::kShape, HypothesisSource::kAlternative));

}  // namespace
}  // namespace recognition
