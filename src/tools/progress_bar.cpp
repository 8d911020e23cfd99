#include "tools/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace recognition {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

ProgressBar::ProgressBar(std::string title, int total)
    : title_(std::move(title)), total_(std::max(1, total)), start_(now()), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_ && done_ > 0) std::fputc('\n', stderr);
}

void ProgressBar::advance(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  if (!terminal_ || (now() - last_drawn_ < 0.1 && done_ < total_)) return;
  last_drawn_ = now();
  constexpr int kWidth = 30;
  const int filled = std::min(kWidth, kWidth * done_ / total_);
  const double left = (last_drawn_ - start_) / done_ * std::max(0, total_ - done_);
  std::fprintf(stderr, "\r%s [%s%s] %d/%d, %.0f s left  %-30.30s", title_.c_str(), std::string(filled, '#').c_str(),
               std::string(kWidth - filled, ' ').c_str(), done_, total_, left, what.c_str());
}

}  // namespace recognition
