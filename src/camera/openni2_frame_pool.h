#pragma once

#include <OpenNI.h>
#include <sensor_msgs/Image.h>

#include <memory>

namespace recognition {

/// Lets OpenNI2's drivers write frames into the data of image messages, so that no pixel is copied between driver and
/// message. A message goes back to the pool when neither OpenNI2 nor any subscriber has it any more.
///
/// Any thread may call. Messages may outlive the pool; streams that write into its buffers may not.
class FramePool : public openni::VideoStream::FrameAllocator {
 public:
  FramePool();
  ~FramePool() override;

  void* allocateFrameBuffer(int size) override;
  void freeFrameBuffer(void* data) override;

  /// The message whose data this buffer is; null when the buffer is not from this pool.
  sensor_msgs::ImagePtr messageOf(const void* data) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace recognition
