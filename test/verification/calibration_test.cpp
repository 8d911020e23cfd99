// What the confidence is worth on hypotheses that its weights were not fitted on: test/data/evidence/README.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "verification/confidence.h"

namespace recognition {
namespace {

/// A hypothesis whose truth is known.
struct Judged {
  std::string set;
  double confidence = 0.0;
  bool right = false;
};

HypothesisSource sourceNamed(const std::string& name) {
  for (const HypothesisSource source : {HypothesisSource::kConsensus, HypothesisSource::kCorrespondence,
                                        HypothesisSource::kShape, HypothesisSource::kAlternative})
    if (name == sourceName(source)) return source;
  throw std::invalid_argument("unknown source " + name);
}

/// "set,source,right" and the items of the evidence.
Judged judge(const std::string& line) {
  std::istringstream text(line);
  std::string set, source, field;
  std::getline(text, set, ',');
  std::getline(text, source, ',');
  const auto next = [&] { return std::getline(text, field, ',') ? std::stod(field) : throw std::out_of_range(line); };
  const bool right = next() > 0.5;
  Evidence evidence;
  evidence.inliers = static_cast<int>(next());
  for (double* item : {&evidence.significance, &evidence.structure, &evidence.peak, &evidence.color_distance,
                       &evidence.depth_fit, &evidence.segment_share, &evidence.illumination_change})
    *item = next();
  return {set, confidence(evidence, sourceNamed(source)), right};
}

class Calibration : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream in(RGBD_TEST_DATA "/evidence/held_out.csv");
    std::string line;
    ASSERT_TRUE(std::getline(in, line));
    ASSERT_EQ(line,
              "set,source,right,inliers,significance,structure,peak,color_distance,depth_fit,segment_share,"
              "illumination_change");
    while (std::getline(in, line)) hypotheses_.push_back(judge(line));
    ASSERT_GT(hypotheses_.size(), 1000u);
  }

  std::vector<Judged> hypotheses_;
};

TEST_F(Calibration, ConfidentHypothesesAreRight) {
  std::map<std::string, std::pair<int, int>> by_set;  // confident, and right of them
  int confident = 0, right = 0;
  for (const Judged& h : hypotheses_) {
    if (h.confidence <= 0.9) continue;
    ++confident;
    right += h.right ? 1 : 0;
    ++by_set[h.set].first;
    by_set[h.set].second += h.right ? 1 : 0;
  }
  EXPECT_GE(confident, 130);  // 136 when the file was made: trust in nothing would pass the next line
  EXPECT_GE(right, 0.97 * confident);
  for (const auto& [set, counts] : by_set) EXPECT_GE(counts.second, 0.97 * counts.first) << set;
  EXPECT_EQ(by_set.count("negative_odd"), 0u);
}

TEST_F(Calibration, MostOfWhatIsRightIsAccepted) {
  int accepted = 0, right = 0, wrong_accepted = 0;
  for (const Judged& h : hypotheses_) {
    right += h.right ? 1 : 0;
    if (h.confidence < 0.5) continue;
    accepted += h.right ? 1 : 0;
    wrong_accepted += h.right ? 0 : 1;
  }
  EXPECT_GE(accepted, 0.9 * right);  // 0.94
  EXPECT_LE(wrong_accepted, 5);      // 3, all of the tote, which lose to better ones
}

/// How far the confidence lies from the share that is right, over five bands, each by its number of hypotheses. Those
/// below 0.1 are left out: they are ten times as many, and nearly all wrong. 0.044 was measured; of 4000 resamplings of
/// the frames 95 % lie below 0.083. Most of the difference is modesty: from 0.5 to 0.9 all but two or three of 40
/// are right.
TEST_F(Calibration, ConfidenceIsTheShareThatIsRight) {
  constexpr size_t kBands = 5;
  struct Band {
    double confidence = 0.0, right = 0.0;
  };
  std::array<Band, kBands> bands;
  int count = 0;
  for (const Judged& h : hypotheses_) {
    if (h.confidence < 0.1) continue;
    Band& band = bands.at(std::min(kBands - 1, static_cast<size_t>(kBands * h.confidence)));
    band.confidence += h.confidence;
    band.right += h.right ? 1.0 : 0.0;
    ++count;
  }
  double error = 0.0;
  for (const Band& band : bands) error += std::abs(band.confidence - band.right) / count;
  RecordProperty("calibration_error", std::to_string(error));
  EXPECT_GE(count, 200);
  EXPECT_LT(error, 0.08);
}

}  // namespace
}  // namespace recognition
