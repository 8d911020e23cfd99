#include "tracking/segments_to_search.h"

#include <gtest/gtest.h>

#include "alignment/synthetic_scene.h"
#include "tracking/explained_pixels.h"

namespace recognition {
namespace {

using synthetic::poseAt;

/// Two objects of one segment each.
class Segments : public ::testing::Test {
 protected:
  Segments() : models_{synthetic::makeModel(box_, "box"), synthetic::makeModel(can_, "can")} { render(); }

  void render() { scene_ = synthetic::render({{box_, box_at_}, {can_, can_at_}}, models_, sensor_); }

  Segmentation select(double stamp) {
    sensor_.seed = static_cast<std::uint32_t>(100.0 * stamp);
    render();
    return segments_.select(stamp, scene_->frame, scene_->segmentation, explained_);
  }
  bool isWorthALook(double stamp) { return segments_.isWorthALook(stamp, scene_->frame, explained_); }

  synthetic::Solid box_ = synthetic::box(1), can_ = synthetic::can(2);
  Pose box_at_ = poseAt({-0.1, 0.0, 0.8}), can_at_ = poseAt({0.15, 0.05, 0.9});
  std::vector<ObjectModel> models_;
  synthetic::Sensor sensor_;
  std::unique_ptr<synthetic::Scene> scene_;
  cv::Mat explained_;
  SegmentsToSearch segments_{5.0};
};

TEST_F(Segments, AllOfTheFirstFrameAndAllAgainAfterAWhile) {
  EXPECT_EQ(2u, select(10.0).patches.size());
  segments_.searched(10.0, true);
  EXPECT_EQ(0u, select(12.0).patches.size());
  EXPECT_FALSE(isWorthALook(12.1));
  EXPECT_TRUE(isWorthALook(15.1));
  EXPECT_EQ(2u, select(15.1).patches.size());
}

TEST_F(Segments, WhatWasNotSearchedInFullIsSearchedAgain) {
  select(10.0);
  EXPECT_TRUE(isWorthALook(10.1));
  segments_.searched(10.0, false);
  EXPECT_TRUE(isWorthALook(10.2));
  EXPECT_EQ(2u, select(10.2).patches.size());
}

TEST_F(Segments, WhatTracksExplainIsLeftOut) {
  select(10.0);
  explained_ = scene_->instance == 0;
  const Segmentation left = select(10.1);
  ASSERT_EQ(1u, left.patches.size());
  EXPECT_EQ(1, left.patches[0].label);
  EXPECT_EQ(0, cv::countNonZero((left.labels > 0) & (scene_->instance == 0)));
  EXPECT_GT(left.patches[0].centroid.x(), 0.0f);
}

TEST_F(Segments, WhatAwaitsAnotherDetectionIsSearchedAgain) {
  select(10.0);
  segments_.searched(10.0, true);
  explained_ = (scene_->instance == 0) & kUnconfirmedPixel;
  EXPECT_TRUE(isWorthALook(10.1));
  EXPECT_EQ(1u, select(10.1).patches.size());
  segments_.searched(10.1, true);
  explained_ = scene_->instance == 0;
  EXPECT_FALSE(isWorthALook(10.2));
}

TEST_F(Segments, WhatChangedIsSearched) {
  select(10.0);
  segments_.searched(10.0, true);
  can_at_.translation().x() += 0.08;
  render();
  EXPECT_TRUE(isWorthALook(10.5));
  const Segmentation left = select(10.5);
  ASSERT_EQ(1u, left.patches.size());
  EXPECT_GT(left.patches[0].centroid.x(), 0.0f);
}

TEST_F(Segments, StampsThatGoBackForgetAll) {
  select(10.0);
  segments_.searched(10.0, true);
  EXPECT_EQ(0u, select(10.5).patches.size());
  EXPECT_EQ(2u, select(3.0).patches.size());
}

}  // namespace
}  // namespace recognition
