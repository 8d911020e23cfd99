#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

namespace recognition {

/// Counts what a stage does and goes wrong with, for /diagnostics (REP 107) and for throttled messages.
class StageMonitor {
 public:
  /// A frame done: `seconds` inside the stage, `latency` from its stamp to now.
  void processed(double seconds, double latency);
  /// A frame given up for a newer one.
  void dropped();
  /// A bad input. True if it is time to tell of it: at once, and while the same problem lasts again after 5 s, 10 s,
  /// 20 s, ... and at last every five minutes. Problems that differ in numbers only are the same.
  bool rejected(const std::string& input, const std::string& problem);
  void setModels(int loaded, const std::vector<std::string>& errors);
  /// What the stage is at: working, nobody listens, stopped.
  void setActivity(const std::string& activity);
  /// The frame took longer than its budget; `left_out` says what was not done, or is empty.
  void overran(const std::string& left_out);
  /// One more line of the report.
  void setValue(const std::string& key, const std::string& value);

  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  mutable std::mutex mutex_;  // guards all: callbacks begin while onInit still runs
  std::uint64_t processed_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t rejected_ = 0;
  std::uint64_t processed_before_ = 0;  // at the last report
  std::uint64_t rejected_before_ = 0;
  ros::WallTime reported_ = ros::WallTime::now();
  double seconds_ = 0.0;
  double latency_ = 0.0;
  std::string last_problem_;
  struct Told {
    ros::WallTime last_seen, next;
    ros::WallDuration interval;
  };
  std::map<std::string, Told> told_;  // by input and problem
  bool has_models_ = false;
  int models_ = 0;
  std::vector<std::string> model_errors_;
  std::string activity_;
  std::uint64_t overruns_ = 0;
  std::string left_out_;
  std::map<std::string, std::string> values_;
};

}  // namespace recognition
