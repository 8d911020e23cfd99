#include "rgbd_recognition/sequence_recognizer.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "rgbd_recognition/model/model_store.h"

namespace recognition {
namespace {

/// A frame of the demo as a film in which nothing moves.
class Film : public ::testing::Test {
 protected:
  Film()
      : database_(ModelStore(RGBD_STORE).loadAll().database),
        frame_(loadBopFrame(readBopSplit(RGBD_TEST_DATA "/demo/test_primesense").front())) {}

  std::shared_ptr<const ModelDatabase> database_;
  RgbdFrame frame_;
};

TEST_F(Film, IsAnsweredInEachFrameAndSearchedWhenThereIsReasonTo) {
  SequenceRecognizer recognizer(RecognizerParameters(), TrackingParameters(), database_, 0.3);
  const auto at = [&](int frame) { return recognizer.next(10.0 + 0.1 * frame, frame_); };
  EXPECT_TRUE(at(0).tracks.empty());
  EXPECT_GT(recognizer.searchSeconds(), 0.0);
  EXPECT_TRUE(at(1).tracks.empty());  // the search goes on beside
  EXPECT_EQ(recognizer.searchSeconds(), 0.0);
  at(2);
  const TrackingOutcome found = at(4);
  ASSERT_FALSE(found.tracks.empty());
  EXPECT_EQ(found.found.size(), found.tracks.size());
  for (int i = 5; i < 45; ++i) {
    const TrackingOutcome outcome = at(i);
    ASSERT_EQ(outcome.tracks.size(), found.tracks.size());
    EXPECT_LT(translationDistance(outcome.tracks[0].fixed_from_object, found.tracks[0].fixed_from_object), 0.003);
  }
  EXPECT_EQ(recognizer.searches(), 1);
  for (int i = 45; i < 60; ++i) at(i);
  EXPECT_EQ(recognizer.searches(), 2);  // all again after search_period
}

TEST_F(Film, OfTimesThatAreNoneIsRefused) {
  EXPECT_THROW(SequenceRecognizer(RecognizerParameters(), TrackingParameters(), database_, -1.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace recognition
