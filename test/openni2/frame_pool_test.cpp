#include <boost/weak_ptr.hpp>
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <set>

#include "camera/openni2_frame_pool.h"

namespace recognition {
namespace {

TEST(FramePool, TheDriversBufferIsTheMessagesData) {
  FramePool pool;
  void* buffer = pool.allocateFrameBuffer(100);
  std::memset(buffer, 7, 100);
  const sensor_msgs::ImagePtr message = pool.messageOf(buffer);
  ASSERT_TRUE(message);
  EXPECT_EQ(buffer, message->data.data());
  pool.freeFrameBuffer(buffer);
  EXPECT_EQ(7, message->data[99]);  // the message keeps it
}

TEST(FramePool, UsesMessagesAgainOnceNobodyHasThem) {
  FramePool pool;
  void* first = pool.allocateFrameBuffer(100);
  sensor_msgs::ImagePtr held = pool.messageOf(first);
  pool.freeFrameBuffer(first);
  void* second = pool.allocateFrameBuffer(100);
  EXPECT_NE(first, second);
  held.reset();
  EXPECT_EQ(first, pool.allocateFrameBuffer(100));
}

TEST(FramePool, GivesEveryFrameABufferOfItsOwn) {
  FramePool pool;
  std::set<void*> buffers;
  for (int i = 0; i < 20; ++i) buffers.insert(pool.allocateFrameBuffer(1000));
  EXPECT_EQ(20u, buffers.size());
}

TEST(FramePool, ServesAnyOrderOfReleaseAndAMessageThatOutlivesIt) {
  auto pool = std::make_unique<FramePool>();
  void* buffer = pool->allocateFrameBuffer(10);
  const sensor_msgs::ImagePtr message = pool->messageOf(buffer);
  pool->freeFrameBuffer(buffer);
  EXPECT_FALSE(pool->messageOf(buffer));
  pool.reset();
  EXPECT_EQ(10u, message->data.size());
}

TEST(FramePool, LeavesNothingBehindOfBuffersThatNobodyGaveBack) {
  auto pool = std::make_unique<FramePool>();
  const boost::weak_ptr<sensor_msgs::Image> message = pool->messageOf(pool->allocateFrameBuffer(10));
  pool.reset();
  EXPECT_TRUE(message.expired());
}

TEST(FramePool, GrowsAMessageThatComesBackSmaller) {
  FramePool pool;
  void* buffer = pool.allocateFrameBuffer(10);
  pool.messageOf(buffer)->data.resize(2);
  pool.freeFrameBuffer(buffer);
  void* again = pool.allocateFrameBuffer(5000);
  EXPECT_EQ(5000u, pool.messageOf(again)->data.size());
}

TEST(FramePool, KnowsNoOtherBuffers) {
  FramePool pool;
  int other = 0;
  EXPECT_FALSE(pool.messageOf(&other));
  pool.freeFrameBuffer(&other);
}

}  // namespace
}  // namespace recognition
