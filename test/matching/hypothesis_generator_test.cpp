#include "matching/hypothesis_generator.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "matching/synthetic_scene.h"
#include "rgbd_recognition/matching/scene_matches.h"

namespace recognition {
namespace {

/// Ten objects; two of them in the scene (object 3 twice), among clutter.
class Generator : public testing::Test {
 protected:
  Generator() {
    database_ = std::make_shared<ModelDatabase>(synthetic::randomDatabase(10, 150, random_));
    for (const int object : {3, 7, 3}) {
      poses_.push_back(synthetic::randomPose(random_));
      synthetic::addInstance(scene_, *database_->objects[object], poses_.back(), 60, 0.002, random_);
    }
    synthetic::addClutter(scene_, 300, random_);
  }

  std::vector<Hypothesis> generate(const MatchingParameters& parameters, GenerationReport* report = nullptr) const {
    const HypothesisGenerator generator(parameters, database_, DescriptorType::kSurf128);
    return generator.generate(scene_, generator.match(scene_), {}, {}, 0, report);
  }

  static bool near(const Hypothesis& hypothesis, int object, const Pose& pose) {
    return hypothesis.object == object && translationDistance(hypothesis.camera_from_object, pose) < 0.005 &&
           rotationDistance(hypothesis.camera_from_object, pose) < 0.05;
  }

  std::mt19937 random_{11};
  std::shared_ptr<ModelDatabase> database_;
  SceneFeatures scene_;
  std::vector<Pose> poses_;
};

MatchingParameters withSearch(SearchMode search) {
  MatchingParameters parameters;
  parameters.search = search;
  return parameters;
}

TEST_F(Generator, IndexFindsObjectsAndBothInstances) {
  const auto hypotheses = generate(withSearch(SearchMode::kIndex));
  ASSERT_EQ(hypotheses.size(), 3u);
  EXPECT_TRUE(near(hypotheses[2], 7, poses_[1]));
  EXPECT_TRUE(near(hypotheses[0], 3, poses_[0]) || near(hypotheses[1], 3, poses_[0]));
  EXPECT_TRUE(near(hypotheses[0], 3, poses_[2]) || near(hypotheses[1], 3, poses_[2]));
  EXPECT_GE(hypotheses[0].consensus.size(), hypotheses[1].consensus.size());
  for (const Hypothesis& hypothesis : hypotheses) EXPECT_GE(hypothesis.consensus.size(), 50u);
}

TEST_F(Generator, ExhaustiveAndIndexAgree) {
  // The paper's direction gives each model feature to one scene feature, so two instances share the features.
  const auto hypotheses = generate(withSearch(SearchMode::kExhaustive));
  ASSERT_GE(hypotheses.size(), 2u);
  EXPECT_TRUE(near(hypotheses[0], 3, poses_[0]) || near(hypotheses[0], 3, poses_[2]));
  EXPECT_TRUE(near(hypotheses.back(), 7, poses_[1]));
  EXPECT_TRUE(near(generate(withSearch(SearchMode::kIndex)).back(), 7, hypotheses.back().camera_from_object));
}

TEST_F(Generator, SameResultForAnyNumberOfThreads) {
  const int before = cv::getNumThreads();
  std::vector<std::vector<Hypothesis>> results;
  for (const int threads : {1, 2, 8}) {
    cv::setNumThreads(threads);
    results.push_back(generate(MatchingParameters()));
  }
  cv::setNumThreads(before);
  for (const auto& result : results) {
    ASSERT_EQ(result.size(), results[0].size());
    for (size_t i = 0; i < result.size(); ++i) {
      EXPECT_EQ(result[i].object, results[0][i].object);
      EXPECT_EQ(result[i].consensus.size(), results[0][i].consensus.size());
      EXPECT_TRUE(result[i].camera_from_object.isApprox(results[0][i].camera_from_object, 0.0));
    }
  }
}

TEST_F(Generator, InactiveFeaturesAndOtherObjectsStayOut) {
  const HypothesisGenerator generator(MatchingParameters(), database_, DescriptorType::kSurf128);
  std::vector<std::uint8_t> active(scene_.points.size(), 1);
  std::fill(active.begin(), active.begin() + 60, std::uint8_t{0});  // the first instance of object 3
  const auto hypotheses = generator.generate(scene_, generator.match(scene_), active, {3}, 1);
  ASSERT_EQ(hypotheses.size(), 1u);
  EXPECT_TRUE(near(hypotheses[0], 3, poses_[2]));
  EXPECT_EQ(hypotheses[0].round, 1);
}

TEST_F(Generator, OneFeatureSupportsAConsensusOnce) {
  for (const Hypothesis& hypothesis : generate(MatchingParameters())) {
    std::set<int> scene_features, model_features;
    for (const Correspondence& pair : hypothesis.consensus) {
      EXPECT_TRUE(scene_features.insert(pair.scene_feature).second);
      EXPECT_TRUE(model_features.insert(pair.model_feature).second);
    }
  }
}

TEST_F(Generator, FlippedLabelGivesBothPoses) {
  // Object 0 carries the texture of its first 40 features twice, half a turn apart.
  auto& features = const_cast<ObjectModel&>(*database_->objects[0]).features[DescriptorType::kSurf128];
  Pose half_turn = Pose::Identity();
  half_turn.linear() = Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (int i = 0; i < 40; ++i) {
    features.positions[40 + i] = half_turn.cast<float>() * features.positions[i];
    features.descriptors.row(i).copyTo(features.descriptors.row(40 + i));
  }
  scene_ = SceneFeatures();
  synthetic::addInstance(scene_, *database_->objects[0], poses_[0], 40, 0.002, random_);
  synthetic::addClutter(scene_, 100, random_);
  const auto hypotheses = generate(MatchingParameters());
  ASSERT_EQ(hypotheses.size(), 2u);
  const Pose flipped = poses_[0] * half_turn;
  EXPECT_TRUE(near(hypotheses[0], 0, poses_[0]) || near(hypotheses[1], 0, poses_[0]));
  EXPECT_TRUE(near(hypotheses[0], 0, flipped) || near(hypotheses[1], 0, flipped));
}

TEST_F(Generator, FeaturesOfAnotherSizeDoNotPair) {
  for (const auto& object : database_->objects) {
    auto& features = const_cast<ObjectModel&>(*object).features[DescriptorType::kSurf128];
    features.sizes.assign(features.positions.size(),
                          object == database_->objects[3] ? 0.2f : 0.04f);  // scene: about 0.04
  }
  scene_.focal_length = 525.0f;
  for (const Hypothesis& hypothesis : generate(MatchingParameters())) EXPECT_EQ(hypothesis.object, 7);
  MatchingParameters any_size;
  any_size.size_tolerance = 1000.0;
  EXPECT_EQ(generate(any_size).size(), 3u);
}

TEST_F(Generator, FeaturesSeenFromBehindDoNotSupport) {
  auto& features = const_cast<ObjectModel&>(*database_->objects[7]).features[DescriptorType::kSurf128];
  const Eigen::Vector3f away = (poses_[1].linear().transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  features.view_directions.assign(features.positions.size(), away);
  for (const Hypothesis& hypothesis : generate(MatchingParameters())) EXPECT_EQ(hypothesis.object, 3);
  MatchingParameters any_view;
  any_view.max_view_angle = 180.0;
  EXPECT_EQ(generate(any_view).size(), 3u);
}

TEST_F(Generator, BudgetIsReported) {
  GenerationReport enough;
  generate(MatchingParameters(), &enough);
  EXPECT_FALSE(enough.budget_exhausted);
  EXPECT_THAT(enough.objects_cut_short, testing::IsEmpty());
  EXPECT_GT(enough.work_ms, 0.0);

  // One texture repeated over the frame and over object 5.
  cv::Mat& descriptors =
      const_cast<ObjectModel&>(*database_->objects[5]).features[DescriptorType::kSurf128].descriptors;
  const cv::Mat texture = descriptors.row(0).clone();
  for (int i = 0; i < descriptors.rows; ++i) texture.copyTo(descriptors.row(i));
  for (int i = 0; i < scene_.image.descriptors.rows; ++i) texture.copyTo(scene_.image.descriptors.row(i));
  MatchingParameters parameters;
  parameters.neighbors_per_object = parameters.neighbors;
  parameters.work_limit_ms = 5.0;
  GenerationReport report;
  generate(parameters, &report);
  EXPECT_TRUE(report.budget_exhausted);
  EXPECT_THAT(report.objects_cut_short, testing::ElementsAre(5));
  EXPECT_LT(report.work_ms, 6.0);
}

TEST_F(Generator, EmptySceneAndEmptyDatabaseGiveNothing) {
  for (const SearchMode search : {SearchMode::kIndex, SearchMode::kExhaustive}) {
    const auto empty = std::make_shared<ModelDatabase>();
    const HypothesisGenerator no_models(withSearch(search), empty, DescriptorType::kSurf128);
    EXPECT_TRUE(no_models.generate(scene_, no_models.match(scene_), {}, {}, 0).empty());
    const HypothesisGenerator generator(withSearch(search), database_, DescriptorType::kSurf128);
    const SceneFeatures nothing;
    EXPECT_TRUE(generator.generate(nothing, generator.match(nothing), {}, {}, 0).empty());
  }
}

TEST_F(Generator, WrongInputThrows) {
  const HypothesisGenerator generator(MatchingParameters(), database_, DescriptorType::kSurf128);
  SceneFeatures sift = scene_;
  sift.image.type = DescriptorType::kSift;
  EXPECT_THROW(generator.match(sift), std::invalid_argument);
  EXPECT_THROW(HypothesisGenerator(MatchingParameters(), database_, DescriptorType::kSift), std::invalid_argument);
  const SceneMatches matches = generator.match(scene_);
  EXPECT_THROW(generator.generate(scene_, matches, {1, 0}, {}, 0), std::invalid_argument);
  EXPECT_THROW(generator.generate(scene_, matches, {}, {10}, 0), std::invalid_argument);
  EXPECT_THROW(generator.generate(scene_, SceneMatches(), {}, {}, 0), std::invalid_argument);
  MatchingParameters bad;
  bad.delta_d = 0.0;
  EXPECT_THROW(HypothesisGenerator(bad, database_, DescriptorType::kSurf128), std::invalid_argument);
}

TEST(MetricSizes, FollowDepthAndFocalLength) {
  SceneFeatures scene;
  EXPECT_TRUE(metricSizes(scene).empty());
  synthetic::addFeature(scene, {-0.1f, 0.0f, 1.0f}, cv::Mat::zeros(1, 128, CV_32FC1));
  EXPECT_EQ(metricSizes(scene)[0], 0.0f);
  scene.focal_length = 525.0f;
  synthetic::addFeature(scene, {0.2f, 0.1f, 2.0f}, cv::Mat::zeros(1, 128, CV_32FC1));
  EXPECT_NEAR(metricSizes(scene)[0], 20.0 * 1.0 / 525.0, 1e-5);
  EXPECT_NEAR(metricSizes(scene)[1], 20.0 * 2.0 / 525.0, 1e-5);
}

}  // namespace
}  // namespace recognition
