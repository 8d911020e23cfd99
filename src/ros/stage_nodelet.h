#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <std_srvs/Trigger.h>

#include "core/stopwatch.h"
#include "ros/lazy_nodelet.h"
#include "ros/messages.h"
#include "ros/model_source.h"
#include "ros/stage_monitor.h"

namespace recognition {

/// What all stages of the pipeline share: start-up that fails loudly, bad inputs told and counted, diagnostics, timing,
/// models. All callbacks of a nodelet run one after another, in its single-threaded queue. No handle may use the other
/// queue: a nodelet unloaded during a callback outlives the queue that does not run it.
class StageNodelet : public LazyNodelet {
 protected:
  /// Reads parameters and builds what needs them; throws to refuse: the reason is logged as FATAL and the load fails.
  /// Makes no publisher, service or timer: a nodelet that refuses is destroyed after its callback queues.
  virtual void configure() = 0;
  /// Makes publishers and services; throws nothing.
  virtual void advertise() = 0;

  /// Throttled message and count; `input` names topics.
  void reject(const std::string& input, const std::string& problem);

  /// Publishes StageTiming and counts.
  void processed(const std_msgs::Header& header, double seconds, int rounds = 1);

  StageMonitor& monitor() { return monitor_; }

  /// For configure(): opens the store of parameter `models`, looked for in this namespace and those above; ~reload will
  /// be offered. `prepare` as in ModelSource::beforeSwap(), for the time from now on.
  void openModels(const ModelSource::Preparation& prepare = nullptr);
  /// The models as they are now; `changed` is set if they are others than at the last call.
  std::shared_ptr<const ModelDatabase> models(bool* changed);
  /// Revision of what models() gave last, and the models of a revision, if they are still here (else the present ones):
  /// stages that work on one frame use the same.
  std::uint64_t modelsRevision() const { return models_->revision; }
  std::shared_ptr<const ModelDatabase> modelsAt(std::uint64_t revision) const;

  /// Names in the private namespace that are not the core's.
  static const std::vector<std::string>& stageParameterNames();

 private:
  void onInit() final;
  bool reload(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  StageMonitor monitor_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::WallTimer diagnostics_timer_;
  ros::Publisher timing_;
  std::shared_ptr<ModelSource> source_;
  std::shared_ptr<void> preparation_;
  std::shared_ptr<const LoadedModels> models_;  // of the last call of models()
  ros::ServiceServer reload_service_;
};

}  // namespace recognition
