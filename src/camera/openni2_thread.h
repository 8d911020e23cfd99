#pragma once

#include <functional>
#include <future>

namespace recognition {

/// A thread for calls to OpenNI2. OpenNI2 2.2.0.33, as Debian and Ubuntu have it, keeps a buffer for every thread that
/// ever called it and asks after all of them when a new one comes; it crashes when one of them has ended. So these
/// threads do not end with the object: they wait for the next one.
class OpenNi2Thread {
 public:
  OpenNi2Thread() = default;
  explicit OpenNi2Thread(std::function<void()> work);
  ~OpenNi2Thread() { join(); }
  OpenNi2Thread(OpenNi2Thread&&) = default;
  OpenNi2Thread& operator=(OpenNi2Thread&&) = default;

  /// Waits for the end of the work; throws what it threw. Nothing happens at a second call.
  void join();

 private:
  std::future<void> done_;
};

}  // namespace recognition
