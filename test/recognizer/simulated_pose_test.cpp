// What becomes of true poses, and of poses beside them, on simulated frames: whatever proposes them.

#include <map>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "evaluation/oracle.h"
#include "recognizer/pose_expectations.h"
#include "recognizer/simulated_frames.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"
#include "verification/confidence.h"

namespace recognition {
namespace {

constexpr double kSimulatedPlace = 0.025;  // metres
constexpr double kShift = 0.03;            // metres
constexpr double kTurn = 25.0;             // degrees

/// A pose beside the truth, with what was done.
struct Moved {
  std::string what;
  Pose camera_from_object;
  bool tilted = false;  ///< turned about an axis in the surface
};

/// Mean normal and middle of the surface that faces the camera, camera's frame.
void facingSurface(const ObjectModel& object, const Pose& pose, Eigen::Vector3d* normal, Eigen::Vector3d* middle) {
  *normal = *middle = Eigen::Vector3d::Zero();
  int facing = 0;
  for (const SurfacePoint& point : object.cloud) {
    const Eigen::Vector3d p = pose * point.position.cast<double>(), n = pose.linear() * point.normal.cast<double>();
    if (n.dot(p) >= 0.0) continue;
    *normal += n;
    *middle += p;
    ++facing;
  }
  normal->normalize();
  *middle /= facing;
}

/// Shifted along the surface and along the view, turned about the surface's normal and about an axis in it.
std::vector<Moved> besides(const ObjectModel& object, const Pose& truth) {
  Eigen::Vector3d normal, middle;
  facingSurface(object, truth, &normal, &middle);
  const Eigen::Vector3d along = normal.cross(Eigen::Vector3d::UnitY()).normalized(), across = normal.cross(along);
  std::vector<Moved> all;
  for (const auto& [what, direction] :
       {std::make_pair("along", along), std::make_pair("across", across), std::make_pair("back", middle.normalized())})
    for (const double sign : {-1.0, 1.0})
      all.push_back({std::string("shifted ") + what, Eigen::Translation3d(sign * kShift * direction) * truth, false});
  for (const auto& [what, axis] : {std::make_pair("the normal", normal), std::make_pair("an axis in it", across)})
    for (const double sign : {-1.0, 1.0})
      all.push_back({std::string("turned about ") + what,
                     Eigen::Translation3d(middle) * Eigen::AngleAxisd(sign * kTurn * M_PI / 180.0, axis) *
                         Eigen::Translation3d(-middle) * truth,
                     axis == across});
  return all;
}

double strength(const VerifiedHypothesis& tested) {
  return tested.accepted() ? explanatoryStrength(tested.evidence, tested.confidence) : 0.0;
}

/// A true instance in a frame that was searched.
struct SimulatedInstance {
  Hypothesis at_truth;
  std::string name;
  double visibility;
};

struct SearchedFrame {
  WorldPreset preset;
  RgbdFrame frame;
  RecognitionResult result;
  std::vector<SimulatedInstance> instances;
};

class SimulatedPose : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    database_ = ModelStore(RGBD_STORE).loadAll().database;
    Recognizer recognizer({}, database_);
    const std::vector<CatalogObject> catalog = demoCatalog();
    for (const auto& [preset, frames] :
         {std::make_pair(WorldPreset::kChallenge, 2), {WorldPreset::kHard, 2}, {WorldPreset::kWide, 3}})
      for (int seed = 1; seed <= frames; ++seed) {
        AnnotatedFrame made = simulatedFrame(catalog, preset, static_cast<std::uint64_t>(seed));
        SearchedFrame searched{preset, made.frame, recognizer.recognize(made.frame), {}};
        for (const AnnotatedObject& truth : made.objects) {
          const int object = indexOf(truth.object_id);
          const int min_consensus = recognizer.parameters().reprojection_verification.min_consensus;
          searched.instances.push_back(
              {trueHypothesis(searched.result, *database_, object, truth.camera_from_object, min_consensus),
               "preset " + std::to_string(static_cast<int>(preset)) + ", seed " + std::to_string(seed) + ", " +
                   database_->objects[static_cast<size_t>(object)]->name,
               truth.visibility.fraction()});
        }
        frames_.push_back(std::move(searched));
      }
  }

  static void TearDownTestSuite() {
    frames_.clear();
    database_.reset();
  }

  static int indexOf(int id) {
    for (size_t i = 0; i < database_->objects.size(); ++i)
      if (database_->objects[i]->challenge_id == id) return static_cast<int>(i);
    throw std::runtime_error("no model of object " + std::to_string(id));
  }

  static Recognizer recognizer(bool refine = true) {
    RecognizerParameters parameters;
    parameters.reprojection_verification.refine = refine;
    return Recognizer(parameters, database_);
  }

  static const ObjectModel& objectOf(const SimulatedInstance& instance) {
    return *database_->objects[static_cast<size_t>(instance.at_truth.object)];
  }

  /// Tests an instance in the moved poses, with and without the features that agree with the truth.
  static std::vector<std::pair<Moved, VerifiedHypothesis>> testAll(const Recognizer& with, const SearchedFrame& one,
                                                                   Hypothesis hypothesis,
                                                                   const std::vector<Moved>& poses) {
    std::vector<Hypothesis> hypotheses;
    for (const bool features : {true, false}) {
      if (!features) {
        hypothesis.consensus.clear();
        hypothesis.source = HypothesisSource::kShape;
      }
      for (const Moved& moved : poses) {
        hypothesis.camera_from_object = moved.camera_from_object;
        hypotheses.push_back(hypothesis);
      }
    }
    std::vector<std::pair<Moved, VerifiedHypothesis>> pairs;
    for (const VerifiedHypothesis& result : with.test(one.frame, one.result, hypotheses))
      pairs.emplace_back(poses[pairs.size() % poses.size()], result);
    return pairs;
  }

  static std::shared_ptr<const ModelDatabase> database_;
  static std::vector<SearchedFrame> frames_;
};

std::shared_ptr<const ModelDatabase> SimulatedPose::database_;
std::vector<SearchedFrame> SimulatedPose::frames_;

TEST_F(SimulatedPose, IsAcceptedWhereItIsSeenAndFeaturesAgree) {
  const Recognizer refining = recognizer(), unrefining = recognizer(false);
  std::map<WorldPreset, std::pair<int, int>> accepted_of;
  for (const SearchedFrame& one : frames_)
    for (const SimulatedInstance& instance : one.instances) {
      const int agreeing = unrefining.test(one.frame, one.result, {instance.at_truth}).front().evidence.inliers;
      if (agreeing < kManyFeatures || instance.visibility < kMinSeen) continue;
      const VerifiedHypothesis at_truth = refining.test(one.frame, one.result, {instance.at_truth}).front();
      auto& [accepted, all] = accepted_of[one.preset];
      ++all;
      accepted += at_truth.accepted() ? 1 : 0;
      EXPECT_TRUE(at_truth.accepted() || one.preset == WorldPreset::kWide)
          << instance.name << ": " << rejectionName(at_truth.rejection) << ", confidence " << at_truth.confidence
          << ", inliers " << agreeing;
      EXPECT_TRUE(isAt(at_truth, instance.at_truth.camera_from_object, kSimulatedPlace) || !at_truth.accepted())
          << instance.name;
    }
  int instances = 0;
  for (const auto& [preset, counts] : accepted_of) {
    instances += counts.second;
    EXPECT_GE(counts.first, 0.85 * counts.second) << "preset " << static_cast<int>(preset);  // blur and bleaching
  }
  EXPECT_GE(instances, 18) << "too few for this test to mean much";
}

/// A pose beside the truth is refused, drawn back, or explains the frame worse than the true pose, which then wins.
TEST_F(SimulatedPose, DoesNotLoseToPosesBesideIt) {
  const Recognizer refining = recognizer();
  int tested = 0, beside = 0;
  for (const SearchedFrame& one : frames_)
    for (const SimulatedInstance& instance : one.instances) {
      const Pose& truth = instance.at_truth.camera_from_object;
      const VerifiedHypothesis best = refining.test(one.frame, one.result, {instance.at_truth}).front();
      const std::vector<Moved> poses = besides(objectOf(instance), truth);
      for (const auto& [moved, result] : testAll(refining, one, instance.at_truth, poses)) {
        ++tested;
        if (!result.accepted() || isAt(result, truth, kSimulatedPlace)) continue;
        ++beside;
        EXPECT_GT(strength(best), strength(result)) << instance.name << " " << moved.what << ", confidence "
                                                    << result.confidence << ", of the truth " << best.confidence;
      }
    }
  EXPECT_GE(tested, 400);
  EXPECT_LE(beside, 0.01 * tested);
}

/// Where nothing draws it back, it is refused; a slight tilt, which leaves the features nearly where they are, may only
/// be worse.
TEST_F(SimulatedPose, IsRefusedBesideItself) {
  const Recognizer unrefining = recognizer(false);
  int tested = 0, at_truth = 0, instances = 0;
  for (const SearchedFrame& one : frames_)
    for (const SimulatedInstance& instance : one.instances) {
      const Pose& truth = instance.at_truth.camera_from_object;
      const VerifiedHypothesis best = unrefining.test(one.frame, one.result, {instance.at_truth}).front();
      const std::vector<Moved> poses = besides(objectOf(instance), truth);
      for (const auto& [moved, result] : testAll(unrefining, one, instance.at_truth, poses)) {
        ++tested;
        if (!result.accepted()) continue;
        EXPECT_TRUE(moved.tilted) << instance.name << " " << moved.what << ", confidence " << result.confidence;
        EXPECT_GT(strength(best), strength(result)) << instance.name << " " << moved.what;
      }
      if (best.evidence.inliers < kManyFeatures || instance.visibility < kMinSeen) continue;
      ++instances;
      at_truth += best.accepted() ? 1 : 0;
    }
  EXPECT_GE(tested, 400);
  EXPECT_GE(at_truth, 0.9 * instances) << "of " << instances << ": what refuses anything proves nothing";
}

}  // namespace
}  // namespace recognition
