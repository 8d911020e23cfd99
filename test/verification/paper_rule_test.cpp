#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "rgbd_recognition/recognizer.h"
#include "verification/acceptance_rule.h"

namespace recognition {
namespace {

Rejection decide(double total, int round, VerificationParameters parameters) {
  parameters.decision = Decision::kPaper;
  parameters.theta_c = 0.4;
  VerifiedHypothesis hypothesis;
  hypothesis.scores.total = total;
  hypothesis.rejection = Rejection::kConflict;  // whatever it was
  makeAcceptanceRule(parameters, round)->decide(&hypothesis);
  return hypothesis.rejection;
}

TEST(PaperRule, Equation17HoldsFromItsThresholdOn) {
  const VerificationParameters parameters;
  EXPECT_EQ(decide(0.4, 0, parameters), Rejection::kNone);  // greater or equal
  EXPECT_EQ(decide(std::nextafter(0.4, 0.0), 0, parameters), Rejection::kConsistency);
  EXPECT_EQ(decide(1.0, 0, parameters), Rejection::kNone);
  EXPECT_EQ(decide(0.0, 0, parameters), Rejection::kConsistency);
}

TEST(PaperRule, HalfOfThetaInFurtherRoundsHasTwoReadings) {
  VerificationParameters parameters;
  parameters.further_rounds = FurtherRounds::kAcceptance;
  EXPECT_EQ(decide(0.2, 1, parameters), Rejection::kNone);
  EXPECT_EQ(decide(std::nextafter(0.2, 0.0), 1, parameters), Rejection::kConsistency);
  EXPECT_EQ(decide(0.2, 0, parameters), Rejection::kConsistency);
  parameters.further_rounds = FurtherRounds::kCandidates;
  EXPECT_EQ(decide(0.39, 1, parameters), Rejection::kConsistency);
  EXPECT_EQ(decide(0.4, 1, parameters), Rejection::kNone);
}

TEST(PaperRule, OnlyAboveHalfOfThetaIsLookedForAgain) {
  for (const FurtherRounds reading : {FurtherRounds::kAcceptance, FurtherRounds::kCandidates}) {
    VerificationParameters parameters;
    parameters.decision = Decision::kPaper;
    parameters.theta_c = 0.4;
    parameters.further_rounds = reading;
    const auto rule = makeAcceptanceRule(parameters, 0);
    VerifiedHypothesis hypothesis;
    hypothesis.scores.total = 0.2;
    EXPECT_FALSE(rule->staysCandidate(hypothesis));
    hypothesis.scores.total = std::nextafter(0.2, 1.0);
    EXPECT_TRUE(rule->staysCandidate(hypothesis));
  }
}

std::string paperYaml() {
  std::ostringstream text;
  text << std::ifstream(std::string(RGBD_SOURCE_DIR) + "/config/paper.yaml").rdbuf();
  return text.str();
}

TEST(PaperConfiguration, ListsEveryParameterThatRecognitionReads) {
  const std::string text = paperYaml();
  RecognizerParameters parameters;
  for (const auto& [group, list] : parameters.groups()) {
    const size_t begin = text.find("\n" + group + ":");
    ASSERT_NE(begin, std::string::npos) << group;
    size_t end = text.find("\n", text.find(":", begin));
    while (end != std::string::npos && end + 1 < text.size() && (text[end + 1] == ' ' || text[end + 1] == '#'))
      end = text.find("\n", end + 1);
    const std::string part = text.substr(begin, end - begin);
    for (const Parameter& p : list)
      EXPECT_NE(part.find("\n  " + p.name + ": "), std::string::npos) << group << "/" << p.name;
  }
}

TEST(PaperConfiguration, MarksWhatIsThePapersAndWhatIsNot) {
  std::istringstream lines(paperYaml());
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  ", 0) != 0) continue;
    EXPECT_TRUE(line.find("# paper") != std::string::npos || line.find("# not given") != std::string::npos ||
                line.find("# off") != std::string::npos || line.find("# unused") != std::string::npos)
        << line;
  }
}

TEST(PaperConfiguration, HasTableThree) {
  const RecognizerParameters p = RecognizerParameters::fromYaml(std::string(RGBD_SOURCE_DIR) + "/config/paper.yaml");
  EXPECT_EQ(p.hypothesis_generation.delta_f, 1.0);
  EXPECT_EQ(p.hypothesis_generation.delta_d, 0.015);
  EXPECT_EQ(p.hypothesis_generation.ransac_iterations, 100);
  EXPECT_EQ(p.hypothesis_generation.alpha, 0.1);
  EXPECT_EQ(p.reprojection_verification.w, 4);
  EXPECT_EQ(p.reprojection_verification.w_c, 0.6);
  EXPECT_EQ(p.reprojection_verification.theta_c, 0.4);
  EXPECT_EQ(p.reprojection_verification.decision, Decision::kPaper);
  EXPECT_EQ(p.segmentation.epsilon, 0.015);
  EXPECT_EQ(p.segmentation.sigma, 0.015);
  EXPECT_EQ(p.segmentation.lambda_min, 4);
  EXPECT_EQ(p.segmentation.f_mixed, 12);
  EXPECT_EQ(p.feature_extraction.descriptor, DescriptorType::kSurf128);
}

}  // namespace
}  // namespace recognition
