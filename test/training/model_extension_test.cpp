#include "training/model_extension.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "../src/training/model_overlap.h"
#include "../src/training/turned_over.h"
#include "model/random_model.h"
#include "meshes/sample_meshes.h"
#include "refusal.h"
#include "training/model_builder.h"
#include "meshes/surface_sampling.h"
#include "simulation/shapes.h"
#include "rgbd_recognition/features/feature_parameters.h"

namespace recognition {
namespace {

using testing::HasSubstr;

constexpr float kHeight = 0.09f;

void addFeature(const ModelFeatures& all, size_t k, ModelFeatures* some) {
  some->descriptors.push_back(all.descriptors.row(static_cast<int>(k)));
  some->positions.push_back(all.positions[k]);
  some->view_directions.push_back(all.view_directions[k]);
  some->orientations.push_back(all.orientations[k]);
  some->sizes.push_back(all.sizes[k]);
  some->views.push_back(all.views[k]);
}

// A printed can, and what two passes see of it: all but the lowest, and, on its head, all but the highest part.
class RoundObject : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    TrainingParameters training;
    training.views = 24;
    training.distances = 1;
    const TexturedMesh can = makeCylinder(0.03, kHeight, blobTexture(768, 5));
    whole_ = new ObjectModel(buildModelFromMesh(can, "can", training, FeatureParameters(), {DescriptorType::kSift}));
  }
  static void TearDownTestSuite() { delete whole_; }

  // What cameras on the side `up` (1 or -1) see.
  static ObjectModel seenFrom(float up) {
    ObjectModel part = *whole_;
    part.rest_planes = {{up * Eigen::Vector3f::UnitZ(), -0.5f * kHeight}};
    part.cloud.clear();
    for (const SurfacePoint& point : whole_->cloud)
      if (up * point.position.z() > -0.5f * kHeight + 0.008f) part.cloud.push_back(point);
    ModelFeatures& features = part.features.begin()->second;
    const ModelFeatures all = features;
    features = {};
    for (int i = 0; i < all.count(); ++i) {
      const auto k = static_cast<size_t>(i);
      if (up * all.view_directions[k].z() < 0.0f) continue;
      addFeature(all, k, &features);
    }
    return part;
  }

  static ObjectModel* whole_;
};
ObjectModel* RoundObject::whole_ = nullptr;

TEST_F(RoundObject, SurfacesThatSlideAlongThemselvesAreContradicted) {
  const ObjectModel above = seenFrom(1.0f), below = seenFrom(-1.0f);
  EXPECT_LT(contradictedShare(above, below, Pose::Identity()), 0.003);
  EXPECT_GT(contradictedShare(above, below, Pose(Eigen::Translation3d(0.0, 0.0, 0.02))), 0.02);
}

// By less than the sides that both saw reach beyond each other: only what they stood on tells.
TEST_F(RoundObject, NothingLiesBelowWhatItStoodOn) {
  ObjectModel above = seenFrom(1.0f), below = seenFrom(-1.0f);
  const Pose sunk(Eigen::Translation3d(0.0, 0.0, -0.006));
  EXPECT_GT(contradictedShare(above, below, sunk), 0.02);
  above.rest_planes.clear(), below.rest_planes.clear();
  EXPECT_LT(contradictedShare(above, below, sunk), 0.003);
}

TEST_F(RoundObject, ContactsLeadBackToWhatItStoodOn) {
  const std::vector<Contact> contacts =
      contactsOf(seenFrom(1.0f), seenFrom(-1.0f), Pose(Eigen::Translation3d(0.0, 0.0, 0.005)));
  EXPECT_GT(contacts.size(), 200u);
  for (const Contact& contact : contacts)
    EXPECT_LT((contact.to.position - contact.from + 0.005f * Eigen::Vector3f::UnitZ()).norm(), 0.001f);
}

// A dozen features, too few for a pose that nothing else speaks for.
TEST_F(RoundObject, OnItsHeadPrintTellsTheTurn) {
  const ObjectModel above = seenFrom(1.0f);
  ObjectModel below = seenFrom(-1.0f);
  ModelFeatures& few = below.features.begin()->second;
  const ModelFeatures& all = above.features.begin()->second;
  few = {};
  for (int i = 0; i < all.count() && few.count() < 12; ++i) {
    const auto k = static_cast<size_t>(i);
    if (std::abs(all.positions[k].z()) > 0.03f) continue;
    addFeature(all, k, &few);
  }
  const Pose pose =
      Pose(Eigen::Translation3d(0.1, 0.0, 0.02)) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized());
  const Pose error = fitModels(above, moved(below, pose)).model_from_addition * pose;
  EXPECT_LT(error.translation().norm(), 0.002);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.03);
  below.rest_planes.clear();
  EXPECT_THROW(fitModels(above, below), std::runtime_error);
}

// No feature: the turn, which a round shape leaves free, between the steps that are tried.
TEST_F(RoundObject, WithoutFeaturesPrintAloneTellsTheTurn) {
  const ObjectModel above = seenFrom(1.0f);
  ObjectModel below = seenFrom(-1.0f);
  ModelFeatures& none = below.features.begin()->second;
  none = {};
  none.descriptors = above.features.begin()->second.descriptors.rowRange(0, 0);
  for (const double turn : {0.0, 0.12, 0.3}) {
    const Pose pose = Pose(Eigen::Translation3d(0.1, 0.0, 0.02)) * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
    const Pose error = fitModels(above, moved(below, pose)).model_from_addition * pose;
    EXPECT_LT(error.translation().norm(), 0.002) << turn;
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.04) << turn;
  }
}

// An angle without texture or features that match, seen from above and, on its head, from below.
TEST(PlainObject, OnItsHeadShapeTellsTheTurn) {
  const cv::Mat grey(8, 8, CV_8UC3, cv::Scalar::all(128));
  ObjectModel above;
  const Eigen::Vector3f long_arm(0.12f, 0.03f, 0.05f), short_arm(0.03f, 0.08f, 0.05f);
  for (const auto& [size, place] : {std::pair(long_arm, Eigen::Vector3f(0.0f, 0.0f, 0.025f)),
                                    std::pair(short_arm, Eigen::Vector3f(-0.045f, 0.055f, 0.025f))})
    for (SurfacePoint point : sampleSurface(boxMesh(size, grey), 0.003, 30000)) {
      point.position += place;
      above.cloud.push_back(point);
    }
  above.rest_planes = {{Eigen::Vector3f::UnitZ(), 0.0f}};
  ObjectModel below = above;
  below.rest_planes = {{-Eigen::Vector3f::UnitZ(), -0.05f}};
  cv::RNG rng(3);
  above.features[DescriptorType::kSurf64] = randomFeatures(DescriptorType::kSurf64, 2500, rng);
  below.features[DescriptorType::kSurf64] = randomFeatures(DescriptorType::kSurf64, 2500, rng);
  for (Eigen::Vector3f& direction : below.features[DescriptorType::kSurf64].view_directions)
    direction.z() = -direction.z();
  const Pose pose =
      Pose(Eigen::Translation3d(0.1, 0.0, 0.02)) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized());
  const Pose error = fitModels(above, moved(below, pose)).model_from_addition * pose;
  EXPECT_LT(error.translation().norm(), 0.002);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.02);
}

// A can that lies, and was turned over: what was bright in one pass was in its own shadow in the other.
TEST_F(RoundObject, LightFromAboveHidesNoPrint) {
  const auto lying = [](float up) {
    ObjectModel can = *whole_;
    can.rest_planes = {{up * Eigen::Vector3f::UnitX(), -0.03f}};
    for (SurfacePoint& point : can.cloud)
      point.rgb = cv::Vec3b((0.75f + 0.25f * up * point.normal.x()) * cv::Vec3f(point.rgb));
    return can;
  };
  const ObjectModel one = lying(1.0f), other = lying(-1.0f);
  EXPECT_GT(textureCorrelation(one, other, Pose::Identity()), 0.8);
  EXPECT_LT(textureCorrelation(one, other, Pose(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()))), 0.3);
}

// Both ends look the same, so that what was seen of one fits the other at least as well.
TEST_F(RoundObject, ItIsSaidThatItWasTurnedOver) {
  const ObjectModel above = seenFrom(1.0f);
  const Pose over(Eigen::AngleAxisd(CV_PI, Eigen::Vector3d::UnitX()));
  ObjectModel below = above;  // seen from above, it is said to have stood on its head
  below.rest_planes = {{Eigen::Vector3f::UnitZ(), -0.5f * kHeight}};
  EXPECT_LT(fitModels(above, below).model_from_addition.translation().norm(), 0.001);
  EXPECT_THROW(fitModels(above, below, Stand::kTurnedOver), std::runtime_error);
  const ModelFit fit = fitModels(above, moved(seenFrom(-1.0f), over), Stand::kTurnedOver);
  EXPECT_LT((fit.model_from_addition * over).translation().norm(), 0.001);
}

// The can's shape leaves its turn and, but for its ends, its height free.
TEST_F(RoundObject, FeaturesHoldWhatTheShapeLeavesFree) {
  const Pose pose =
      Pose(Eigen::Translation3d(0.1, 0.0, 0.02)) * Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized());
  const ModelFit fit = fitModels(seenFrom(1.0f), moved(seenFrom(-1.0f), pose));
  const Pose error = fit.model_from_addition * pose;
  EXPECT_LT(error.translation().norm(), 0.001);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.01);
  EXPECT_LT(fit.contradicted, 0.003);
}

// All features of the second model lie 20 mm off, as if its texture were repeated up the can.
TEST_F(RoundObject, AFitThatTheEndsContradictIsRefused) {
  ObjectModel below = seenFrom(-1.0f);
  for (Eigen::Vector3f& p : below.features.begin()->second.positions) p.z() -= 0.02f;
  ObjectModel plain = seenFrom(1.0f);
  for (ObjectModel* model : {&plain, &below})
    for (SurfacePoint& point : model->cloud) {  // a texture that is the same at each height
      const double angle = std::atan2(point.position.y(), point.position.x());
      point.rgb = cv::Vec3b::all(cv::saturate_cast<uchar>(127.0 + 100.0 * std::sin(3.0 * angle)));
    }
  EXPECT_THAT(refusal<std::runtime_error>([&] { fitModels(plain, below); }), HasSubstr("in part only"));
}

// Most features agree on a pose that the surfaces contradict, as those of a texture that is on the object twice.
TEST_F(RoundObject, TheNextBestPoseIsTried) {
  const ObjectModel above = seenFrom(1.0f);
  ObjectModel below = seenFrom(-1.0f);
  ModelFeatures& features = below.features.begin()->second;
  ModelFeatures decoys = moved(above.features.begin()->second, Pose(Eigen::Translation3d(0.0, 0.0, 0.03)));
  for (Eigen::Vector3f& direction : decoys.view_directions) direction.z() = -direction.z();  // seen from below, too
  cv::vconcat(decoys.descriptors, features.descriptors, features.descriptors);
  const auto prepend = [](auto& to, const auto& from) { to.insert(to.begin(), from.begin(), from.end()); };
  prepend(features.positions, decoys.positions);
  prepend(features.view_directions, decoys.view_directions);
  prepend(features.orientations, decoys.orientations);
  prepend(features.sizes, decoys.sizes);
  prepend(features.views, decoys.views);
  const ModelFit fit = fitModels(above, below);
  EXPECT_LT(fit.model_from_addition.translation().norm(), 0.001);
}

}  // namespace
}  // namespace recognition
