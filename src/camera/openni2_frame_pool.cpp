#include "camera/openni2_frame_pool.h"

#include <mutex>
#include <unordered_map>
#include <vector>

namespace recognition {
namespace {

constexpr size_t kMaxFree = 8;  // messages kept for reuse

}  // namespace

struct FramePool::State {
  std::mutex mutex;  // protects both
  std::vector<std::unique_ptr<sensor_msgs::Image>> free;
  std::unordered_map<const void*, sensor_msgs::ImagePtr> with_openni;

  std::unique_ptr<sensor_msgs::Image> take() {
    const std::lock_guard<std::mutex> lock(mutex);
    if (free.empty()) return std::make_unique<sensor_msgs::Image>();
    std::unique_ptr<sensor_msgs::Image> message = std::move(free.back());
    free.pop_back();
    return message;
  }

  void giveBack(sensor_msgs::Image* message) {
    std::unique_ptr<sensor_msgs::Image> owned(message);
    const std::lock_guard<std::mutex> lock(mutex);
    if (free.size() < kMaxFree) free.push_back(std::move(owned));
  }
};

FramePool::FramePool() : state_(std::make_shared<State>()) {}

FramePool::~FramePool() {
  decltype(State::with_openni) left;  // their deleters lock the mutex: they must go after the lock has gone
  const std::lock_guard<std::mutex> lock(state_->mutex);
  left.swap(state_->with_openni);
}

void* FramePool::allocateFrameBuffer(int size) {
  std::unique_ptr<sensor_msgs::Image> message = state_->take();
  message->data.resize(size);
  void* data = message->data.data();
  sensor_msgs::ImagePtr shared(message.release(), [state = state_](sensor_msgs::Image* m) { state->giveBack(m); });
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->with_openni[data] = std::move(shared);
  return data;
}

void FramePool::freeFrameBuffer(void* data) {
  sensor_msgs::ImagePtr last;  // its deleter locks the mutex: it must go after the lock has gone
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const auto found = state_->with_openni.find(data);
  if (found == state_->with_openni.end()) return;
  last = std::move(found->second);
  state_->with_openni.erase(found);
}

sensor_msgs::ImagePtr FramePool::messageOf(const void* data) const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const auto found = state_->with_openni.find(data);
  return found == state_->with_openni.end() ? sensor_msgs::ImagePtr() : found->second;
}

}  // namespace recognition
