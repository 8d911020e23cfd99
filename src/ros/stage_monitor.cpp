#include "ros/stage_monitor.h"

#include <algorithm>
#include <cctype>

namespace recognition {
namespace {

const ros::WallDuration kTellAgain(5.0), kTellAtLast(300.0);
const ros::WallDuration kOver(60.0);  // without it, a problem is a new one when it comes again
constexpr size_t kMaxTold = 100;

std::string withoutNumbers(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); }), text.end());
  return text;
}

}  // namespace

void StageMonitor::processed(double seconds, double latency) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++processed_;
  seconds_ = seconds;
  latency_ = latency;
}

void StageMonitor::dropped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++dropped_;
}

bool StageMonitor::rejected(const std::string& input, const std::string& problem) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++rejected_;
  last_problem_ = problem + " [" + input + "]";
  const ros::WallTime now = ros::WallTime::now();
  if (told_.size() > kMaxTold) told_.clear();
  Told& told = told_[input + withoutNumbers(problem)];
  const bool is_new = told.next.isZero() || now - told.last_seen > kOver + told.interval;
  told.last_seen = now;
  if (!is_new && now < told.next) return false;
  told.interval = is_new ? kTellAgain : std::min(told.interval * 2.0, kTellAtLast);
  told.next = now + told.interval;
  return true;
}

void StageMonitor::setModels(int loaded, const std::vector<std::string>& errors) {
  const std::lock_guard<std::mutex> lock(mutex_);
  has_models_ = true;
  models_ = loaded;
  model_errors_ = errors;
}

void StageMonitor::setActivity(const std::string& activity) {
  const std::lock_guard<std::mutex> lock(mutex_);
  activity_ = activity;
}

void StageMonitor::overran(const std::string& left_out) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++overruns_;
  left_out_ = left_out;
}

void StageMonitor::setValue(const std::string& key, const std::string& value) {
  const std::lock_guard<std::mutex> lock(mutex_);
  values_[key] = value;
}

void StageMonitor::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::WallTime now = ros::WallTime::now();
  const double rate = static_cast<double>(processed_ - processed_before_) / std::max(1e-3, (now - reported_).toSec());
  status.summary(DiagnosticStatus::OK, activity_);
  if (rejected_ > rejected_before_) status.mergeSummary(DiagnosticStatus::WARN, last_problem_);
  if (!model_errors_.empty()) status.mergeSummary(DiagnosticStatus::WARN, "models skipped");
  if (has_models_ && models_ == 0) status.mergeSummary(DiagnosticStatus::ERROR, "no models loaded");
  status.add("frames processed", processed_);
  status.add("frames dropped", dropped_);
  status.add("bad inputs", rejected_);
  status.add("last bad input", last_problem_);
  if (overruns_ > 0) {
    status.add("budget overruns", overruns_);
    status.add("last left out", left_out_);
  }
  status.addf("rate [1/s]", "%.2f", rate);
  status.addf("last frame [s]", "%.4f", seconds_);
  status.addf("last latency [s]", "%.4f", latency_);
  if (has_models_) status.add("models loaded", models_);
  for (const auto& [key, value] : values_) status.add(key, value);
  for (const std::string& error : model_errors_) status.add("model skipped", error);
  processed_before_ = processed_;
  rejected_before_ = rejected_;
  reported_ = now;
}

}  // namespace recognition
