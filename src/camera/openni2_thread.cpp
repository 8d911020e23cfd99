#include "camera/openni2_thread.h"

#include <condition_variable>
#include <mutex>
#include <queue>
#include <thread>

namespace recognition {
namespace {

/// Never destroyed: its threads wait in it when the process ends.
struct Pool {
  std::mutex mutex;  // protects all
  std::condition_variable queued;
  std::queue<std::packaged_task<void()>> queue;
  size_t idle = 0;

  void work() {
    std::unique_lock<std::mutex> lock(mutex);
    while (true) {
      ++idle;
      queued.wait(lock, [this] { return !queue.empty(); });
      --idle;
      std::packaged_task<void()> task = std::move(queue.front());
      queue.pop();
      lock.unlock();
      task();
      task = {};
      lock.lock();
    }
  }

  void add(std::packaged_task<void()> task) {
    const std::lock_guard<std::mutex> lock(mutex);
    queue.push(std::move(task));
    if (queue.size() > idle) std::thread(&Pool::work, this).detach();
    queued.notify_one();
  }
};

Pool& pool() {
  static Pool* const pool = new Pool;
  return *pool;
}

}  // namespace

OpenNi2Thread::OpenNi2Thread(std::function<void()> work) {
  std::packaged_task<void()> task(std::move(work));
  done_ = task.get_future();
  pool().add(std::move(task));
}

void OpenNi2Thread::join() {
  if (done_.valid()) done_.get();
}

}  // namespace recognition
