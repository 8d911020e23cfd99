#pragma once

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>

namespace recognition::openni2 {

constexpr int kTimeout = 10000;  // ms: only a broken device takes that long

inline openni::VideoFrameRef nextFrame(openni::VideoStream& stream) {
  openni::VideoStream* streams[] = {&stream};
  int ready = -1;
  openni::VideoFrameRef frame;
  EXPECT_EQ(openni::STATUS_OK, openni::OpenNI::waitForAnyStream(streams, 1, &ready, kTimeout));
  EXPECT_EQ(openni::STATUS_OK, stream.readFrame(&frame));
  return frame;
}

/// Frames of one moment: OpenNI2 hands out whichever is the newest of each stream.
inline void nextPair(openni::VideoStream& color, openni::VideoStream& depth, openni::VideoFrameRef* color_frame,
                     openni::VideoFrameRef* depth_frame) {
  *color_frame = nextFrame(color);
  *depth_frame = nextFrame(depth);
  while (color_frame->isValid() && depth_frame->isValid() &&
         color_frame->getFrameIndex() != depth_frame->getFrameIndex()) {
    if (color_frame->getFrameIndex() < depth_frame->getFrameIndex()) {
      *color_frame = nextFrame(color);
    } else {
      *depth_frame = nextFrame(depth);
    }
  }
}

inline openni::VideoMode mode(openni::PixelFormat format, int width, int height, int fps) {
  openni::VideoMode mode;
  mode.setPixelFormat(format);
  mode.setResolution(width, height);
  mode.setFps(fps);
  return mode;
}

inline uint16_t depthAt(const openni::VideoFrameRef& frame, int u, int v) {
  return static_cast<const uint16_t*>(frame.getData())[v * frame.getWidth() + u];
}

/// Which frame of the test recording a colour frame shows.
inline int recordedIndex(const openni::VideoFrameRef& frame) {
  return (static_cast<const openni::RGB888Pixel*>(frame.getData())[0].r - 40) / 50;
}

/// Once everything that OpenNI2's drivers read on starting is in place.
inline int runTestsWithOpenNi2() {
  if (openni::OpenNI::initialize() != openni::STATUS_OK) {
    std::fprintf(stderr, "OpenNI2: %s\n", openni::OpenNI::getExtendedError());
    return 1;
  }
  const int result = RUN_ALL_TESTS();
  openni::OpenNI::shutdown();
  return result;
}

}  // namespace recognition::openni2
