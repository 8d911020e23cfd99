#pragma once

#include <functional>

#include <ros/callback_queue_interface.h>

namespace recognition {

/// A function in a callback queue.
class QueuedCall : public ros::CallbackInterface {
 public:
  explicit QueuedCall(const std::function<void()>& function) : function_(function) {}
  CallResult call() override {
    function_();
    return Success;
  }

 private:
  const std::function<void()> function_;
};

}  // namespace recognition
