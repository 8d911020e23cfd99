#pragma once

#include <libfreenect.h>

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <queue>
#include <string>
#include <thread>
#include <vector>

namespace recognition::openni2 {

/// libfreenect is not made for several threads: all calls into it happen on this one, which fetches USB events between
/// them. Frames come out of it, too.
class FreenectThread {
 public:
  /// `idle` is called on the thread about every second while no one else has work for it. Throws std::runtime_error
  /// without libusb.
  explicit FreenectThread(std::function<void()> idle);
  /// The thread must have stopped.
  ~FreenectThread();

  /// Ends the thread. False when it has not ended after half a second: it is in `idle`, in a call that waits for the
  /// caller. It will end later; until then the object must live on.
  bool stop();
  bool stopping();

  /// Runs `work` on the thread and waits for it. At once when called from the thread itself.
  void call(const std::function<void()>& work);

  /// For use within call(): the library's context, streams that run (events are fetched while there are any), and what
  /// the library last complained about.
  freenect_context* context() { return context_; }
  void countStream(int change) { running_streams_ += change; }
  std::string takeComplaints();
  /// The library lost a device while fetching events.
  bool takeLoss();

 private:
  void run();
  void workOff();
  static void log(freenect_context*, freenect_loglevel level, const char* message);

  const std::function<void()> idle_;
  freenect_context* context_ = nullptr;
  int running_streams_ = 0;  ///< the thread's own
  bool lost_ = false;        ///< the thread's own

  std::mutex mutex_;  ///< protects the queue and stopping_
  std::condition_variable queued_;
  std::queue<std::packaged_task<void()>> queue_;
  bool stopping_ = false;
  std::promise<void> ended_;
  std::thread thread_;
};

/// A Kinect that is plugged in.
struct FreenectAddress {
  std::string uri;  ///< freenect:<serial>, or freenect:<index> when the device does not tell a serial number of its own
  std::string serial;  ///< may be empty
  int index = 0;       ///< on the bus
};

/// Must run on the thread.
std::vector<FreenectAddress> listKinects(freenect_context* context);

}  // namespace recognition::openni2
