// What becomes of true poses, and of poses beside them, on the demo's real frames: whatever proposes them.
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "evaluation/oracle.h"
#include "recognizer/pose_expectations.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {
namespace {

constexpr double kSamePlace = 0.02;  // metres

/// A true instance of an object of the store, in a frame that was searched.
struct Instance {
  Hypothesis at_truth;
  std::string name;
};

class TruePose : public ::testing::Test {
 protected:
  /// Calls `visit(frame, result, instance, test)` for each true instance.
  template <typename Visit>
  void forEachInstance(const Visit& visit) {
    const auto database = ModelStore(RGBD_STORE).loadAll().database;
    Recognizer recognizer({}, database);
    for (const BopFrame& source : readBopSplit(RGBD_TEST_DATA "/demo/test_primesense")) {
      const RgbdFrame frame = loadBopFrame(source);
      const RecognitionResult result = recognizer.recognize(frame);
      const auto test = [&](const Hypothesis& one) { return recognizer.test(frame, result, {one}).front(); };
      for (const GroundTruth& truth : source.ground_truth)
        for (size_t i = 0; i < database->objects.size(); ++i)
          if (database->objects[i]->challenge_id == truth.object_id)
            visit(Instance{trueHypothesis(result, *database, static_cast<int>(i), truth.camera_from_object,
                                          RecognizerParameters().reprojection_verification.min_consensus),
                           source.name() + " " + database->objects[i]->name},
                  test);
    }
  }
};

/// Moves a pose about the object's origin, in the camera's frame.
Pose moved(const Pose& pose, const Eigen::Vector3d& shift, double degrees) {
  Pose result = pose;
  result.linear() = Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitZ()) * pose.linear();
  result.translation() += shift;
  return result;
}

TEST_F(TruePose, IsAcceptedWhereItIsSeenAndFeaturesAgree) {
  int tested = 0;
  forEachInstance([&](const Instance& instance, const auto& test) {
    const VerifiedHypothesis at_truth = test(instance.at_truth);
    if (instance.at_truth.consensus.size() < kManyFeatures || at_truth.scores.visible < kMinSeen) return;
    EXPECT_TRUE(at_truth.accepted()) << instance.name << ": " << rejectionName(at_truth.rejection) << ", confidence "
                                     << at_truth.confidence;
    EXPECT_TRUE(isAt(at_truth, instance.at_truth.camera_from_object, kSamePlace)) << instance.name;
    ++tested;
  });
  EXPECT_GE(tested, 6) << "too few for this test to mean much";
}

TEST_F(TruePose, IsNotAcceptedBesideItself) {
  int tested = 0;
  forEachInstance([&](const Instance& instance, const auto& test) {
    const Pose truth = instance.at_truth.camera_from_object;
    for (const Pose& beside : {moved(truth, {0.03, 0.0, 0.0}, 0.0), moved(truth, {0.0, 0.03, 0.0}, 0.0),
                               moved(truth, {0.0, 0.0, 0.03}, 0.0), moved(truth, {0.0, 0.0, 0.0}, 25.0)}) {
      Hypothesis wrong;  // without the features that would draw it back
      wrong.object = instance.at_truth.object;
      wrong.camera_from_object = beside;
      wrong.source = HypothesisSource::kShape;
      const VerifiedHypothesis result = test(wrong);
      EXPECT_TRUE(!result.accepted() || isAt(result, truth, kSamePlace))
          << instance.name << ", confidence " << result.confidence;
      ++tested;
    }
  });
  EXPECT_GE(tested, 24);
}

}  // namespace
}  // namespace recognition
