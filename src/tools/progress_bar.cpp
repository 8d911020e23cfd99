#include "tools/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace recognition {
namespace {

constexpr double kInterval = 0.1;  // seconds between two drawings

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

ProgressBar::ProgressBar(std::string title, int total)
    : title_(std::move(title)), total_(std::max(1, total)), start_(now()), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_ && last_drawn_ >= 0.0) std::fputc('\n', stderr);
}

void ProgressBar::advance(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  if (terminal_ && (now() - last_drawn_ >= kInterval || done_ >= total_)) draw(done_, what);
}

void ProgressBar::within(double share, const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (terminal_ && now() - last_drawn_ >= kInterval) draw(done_ + std::clamp(share, 0.0, 1.0), what);
}

void ProgressBar::draw(double done, const std::string& what) {
  last_drawn_ = now();
  constexpr int kWidth = 30;
  const int filled = std::clamp(static_cast<int>(kWidth * done / total_), 0, kWidth);
  char left[32] = "";
  if (done > 0.0)
    std::snprintf(left, sizeof left, "%.0f s left", (last_drawn_ - start_) / done * std::max(0.0, total_ - done));
  std::fprintf(stderr, "\r%s [%s%s] %d/%d, %s  %-30.30s", title_.c_str(), std::string(filled, '#').c_str(),
               std::string(kWidth - filled, ' ').c_str(), done_, total_, left, what.c_str());
}

}  // namespace recognition
