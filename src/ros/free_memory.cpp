#include "ros/free_memory.h"

#include <atomic>
#include <chrono>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace recognition {

void returnFreeMemory() {
#ifdef __GLIBC__
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kPeriod(10);
  static std::atomic<Clock::rep> next{0};  // of the clock's ticks: nodelets of a manager share the process
  const Clock::time_point now = Clock::now();
  Clock::rep due = next.load();
  if (now.time_since_epoch().count() < due) return;
  if (next.compare_exchange_strong(due, (now + kPeriod).time_since_epoch().count())) malloc_trim(0);
#endif
}

}  // namespace recognition
