#pragma once

#include <mutex>
#include <string>

namespace recognition {

/// Progress of long work on standard error: a bar with the time left on a terminal, nothing otherwise.
/// Safe to use from several threads.
class ProgressBar {
 public:
  ProgressBar(std::string title, int total);
  ~ProgressBar();

  /// One more piece of work is done; `what` names it.
  void advance(const std::string& what);

  /// The piece of work at hand is done to this share, 0 to 1.
  void within(double share, const std::string& what);

 private:
  void draw(double done, const std::string& what);

  std::mutex mutex_;  // guards the two below: workers advance, each draws
  int done_ = 0;
  double last_drawn_ = -1.0;
  const std::string title_;
  const int total_;
  const double start_;
  const bool terminal_;
};

}  // namespace recognition
