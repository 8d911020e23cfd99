// What is no trained object is refused, though a feature and its shape speak for it: blank planes, leaflets, boards and
// edges of a shelf, boxes of a trained object's size.
#include <algorithm>
#include <map>
#include <memory>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "recognizer/simulated_frames.h"
#include "rgbd_recognition/model/model_store.h"
#include "rgbd_recognition/recognizer.h"

namespace recognition {
namespace {

constexpr int kStep = 60;         // pixels between places that are tried
constexpr int kNormalReach = 6;   // pixels, for a surface's normal
constexpr double kSmooth = 0.05;  // metres, of that triangle's sides

/// A place on a surface: x along it, z out of it.
std::vector<Pose> surfacePlaces(const RgbdFrame& frame) {
  const CameraModel camera = frame.depthCamera();
  const auto at = [&](int u, int v) { return camera.unproject(u, v, 1e-3 * frame.depth.at<std::uint16_t>(v, u)); };
  std::vector<Pose> places;
  for (int v = kStep / 2; v + kNormalReach < frame.depth.rows; v += kStep)
    for (int u = kStep / 2; u + kNormalReach < frame.depth.cols; u += kStep) {
      const Eigen::Vector3d p = at(u, v), right = at(u + kNormalReach, v), below = at(u, v + kNormalReach);
      if (std::min({p.z(), right.z(), below.z()}) <= 0.0) continue;
      if ((right - p).norm() > kSmooth || (below - p).norm() > kSmooth) continue;
      Pose place = Pose::Identity();
      place.translation() = p;
      place.linear().col(2) = (below - p).cross(right - p).normalized();
      place.linear().col(0) = (right - p).normalized();
      place.linear().col(1) = place.linear().col(2).cross(place.linear().col(0)).normalized();
      place.linear().col(0) = place.linear().col(1).cross(place.linear().col(2));
      places.push_back(place);
    }
  return places;
}

/// The one correspondence that a place may have: the nearest scene feature with the nearest model feature.
std::vector<Correspondence> nearestPair(const SceneFeatures& scene, const ObjectModel& object, const Pose& pose,
                                        const Eigen::Vector3d& place) {
  const ModelFeatures& model = object.features.at(scene.image.type);
  if (scene.points.empty() || model.positions.empty()) return {};
  const auto nearest = [](const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& to) {
    const auto closer = [&](const auto& a, const auto& b) {
      return (a.template cast<double>() - to).squaredNorm() < (b.template cast<double>() - to).squaredNorm();
    };
    return static_cast<int>(std::min_element(points.begin(), points.end(), closer) - points.begin());
  };
  return {{nearest(scene.points, place), nearest(model.positions, pose.inverse() * place), 0.3f}};
}

using Kind = std::pair<bool, bool>;  // a shelf, blank

/// Frames of decoys that were searched; each is made once.
struct Searched {
  explicit Searched(const Kind& kind)
      : made(decoyFrame(demoCatalog(), {kind.first, kind.second}, 3)),
        result(Recognizer({}, ModelStore(RGBD_STORE).loadAll().database).recognize(made.frame)) {}

  static const Searched& of(const Kind& kind) {
    static std::map<Kind, std::unique_ptr<Searched>> made;
    std::unique_ptr<Searched>& one = made[kind];
    if (!one) one = std::make_unique<Searched>(kind);
    return *one;
  }

  AnnotatedFrame made;
  RecognitionResult result;
};

class Decoys : public ::testing::TestWithParam<Kind> {
 protected:
  Decoys()
      : database_(ModelStore(RGBD_STORE).loadAll().database),
        recognizer_({}, database_),
        catalog_(demoCatalog()),
        made_(Searched::of(GetParam()).made),
        result_(Searched::of(GetParam()).result) {}

  const CatalogObject& meshOf(const ObjectModel& object) const {
    const auto same = [&](const CatalogObject& one) { return one.id == object.challenge_id; };
    return *std::find_if(catalog_.begin(), catalog_.end(), same);
  }

  void add(int object, const Pose& pose, const Eigen::Vector3d& place, std::vector<Hypothesis>* all) const {
    Hypothesis hypothesis;
    hypothesis.object = object;
    hypothesis.camera_from_object = pose;
    hypothesis.source = HypothesisSource::kCorrespondence;
    hypothesis.consensus = nearestPair(result_.features, *database_->objects[static_cast<size_t>(object)], pose, place);
    all->push_back(hypothesis);
  }

  void expectRefused(const std::vector<Hypothesis>& hypotheses) const {
    int compared = 0;
    for (const VerifiedHypothesis& tested : recognizer_.test(made_.frame, result_, hypotheses)) {
      compared += tested.level >= TestLevel::kRefined ? 1 : 0;
      EXPECT_FALSE(tested.accepted()) << database_->objects[static_cast<size_t>(tested.hypothesis.object)]->name
                                      << ", confidence " << tested.confidence << ", matched " << tested.evidence.matched
                                      << ", peak " << tested.evidence.peak << ", at "
                                      << tested.camera_from_object.translation().transpose();
    }
    EXPECT_GE(compared, static_cast<int>(hypotheses.size()) / 5) << "of " << hypotheses.size() << ": no surface fits";
  }

  std::shared_ptr<const ModelDatabase> database_;
  Recognizer recognizer_;
  std::vector<CatalogObject> catalog_;
  const AnnotatedFrame& made_;
  const RecognitionResult& result_;
};

TEST_P(Decoys, AreNotDetected) {
  for (const VerifiedHypothesis& one : result_.detections)
    ADD_FAILURE() << database_->objects[static_cast<size_t>(one.hypothesis.object)]->name << ", confidence "
                  << one.confidence;
  EXPECT_GT(result_.hypotheses.size(), 10u) << "nothing was proposed";
}

TEST_P(Decoys, AreRefusedWhereverAFaceLiesFlat) {
  const std::vector<Pose> places = surfacePlaces(made_.frame);
  ASSERT_GT(places.size(), 30u);
  std::vector<Hypothesis> hypotheses;
  for (size_t i = 0; i < places.size(); ++i)
    for (int object = 0; object < static_cast<int>(database_->objects.size()); ++object) {
      const MeshBox box = boxOf(meshOf(*database_->objects[static_cast<size_t>(object)]));
      // One of its six faces on each place, in one of four rotations: which, goes round.
      const auto k = static_cast<int>(i) + object;
      const Eigen::Vector3d out = (k % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(k / 2 % 3);
      const Eigen::Vector3d face = box.middle + 0.5 * box.size.cwiseProduct(out);
      const Pose place_from_object = Eigen::AngleAxisd(0.5 * M_PI * (k / 6 % 4), Eigen::Vector3d::UnitZ()) *
                                     Eigen::Quaterniond::FromTwoVectors(out, Eigen::Vector3d::UnitZ()) *
                                     Eigen::Translation3d(-face);
      add(object, places[i] * place_from_object, places[i].translation(), &hypotheses);
    }
  expectRefused(hypotheses);
}

TEST_P(Decoys, OfAnObjectsSizeAreRefusedInItsPlace) {
  std::vector<Hypothesis> hypotheses;
  for (const AnnotatedObject& decoy : made_.objects)
    for (int object = 0; object < static_cast<int>(database_->objects.size()); ++object) {
      if (database_->objects[static_cast<size_t>(object)]->challenge_id != decoy.object_id) continue;
      const MeshBox box = boxOf(meshOf(*database_->objects[static_cast<size_t>(object)]));
      for (int flip = 0; flip < 4; ++flip) {
        Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
        if (flip > 0) turn = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::Unit(flip - 1)).toRotationMatrix();
        const Pose pose = decoy.camera_from_object * Pose(turn) * Eigen::Translation3d(-box.middle);
        const Eigen::Vector3d middle = decoy.camera_from_object.translation();
        add(object, pose, middle * (1.0 - 0.5 * box.size.minCoeff() / middle.norm()), &hypotheses);
      }
    }
  ASSERT_EQ(hypotheses.size(), 16u);
  expectRefused(hypotheses);
}

INSTANTIATE_TEST_SUITE_P(TableAndShelf, Decoys,
                         ::testing::Values(Kind(false, false), Kind(false, true), Kind(true, true)));

}  // namespace
}  // namespace recognition
