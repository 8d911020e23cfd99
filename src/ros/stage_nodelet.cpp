#include "ros/stage_nodelet.h"

#include <stdexcept>

#include <boost/make_shared.hpp>

#include "ros/free_memory.h"
#include "ros/absolute_path.h"
#include "ros/parameters.h"

namespace recognition {

void StageNodelet::onInit() {
  bool lazy = true;
  try {
    lazy = parameterOr(getPrivateNodeHandle(), "lazy", lazy);
    configure();
  } catch (const std::exception& error) {
    NODELET_FATAL("%s", error.what());
    throw;
  }
  timing_ = getNodeHandle().advertise<messages::StageTiming>("timing", 10);
  if (source_) reload_service_ = getPrivateNodeHandle().advertiseService("reload", &StageNodelet::reload, this);
  advertise();
  startListening(lazy);
  updater_ = std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(), getName());
  updater_->setHardwareID("none");
  updater_->add("pipeline stage", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    monitor_.setActivity(!enabled() ? "stopped" : listening() ? "working" : "nobody listens");
    monitor_.fill(status);
  });
  diagnostics_timer_ = getNodeHandle().createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
    updater_->update();
    returnFreeMemory();
  });
}

void StageNodelet::reject(const std::string& input, const std::string& problem) {
  if (monitor_.rejected(input, problem)) NODELET_ERROR("%s [%s]", problem.c_str(), input.c_str());
}

void StageNodelet::processed(const std_msgs::Header& header, double seconds, int rounds) {
  const double latency = (ros::Time::now() - header.stamp).toSec();
  monitor_.processed(seconds, latency);
  const auto timing = boost::make_shared<messages::StageTiming>();
  timing->header = header;
  timing->stage = getName().substr(getName().rfind('/') + 1);
  timing->seconds = seconds;
  timing->latency = latency;
  timing->rounds = static_cast<std::uint32_t>(rounds);
  timing_.publish(timing);
}

void StageNodelet::openModels(const ModelSource::Preparation& prepare) {
  std::string key;
  if (!getPrivateNodeHandle().searchParam("models", key))
    throw std::invalid_argument(getPrivateNodeHandle().resolveName("models") +
                                " is not set: it names the folder of trained models");
  source_ = ModelSource::open(absolutePath(requiredString(getPrivateNodeHandle(), key)));
  if (prepare) preparation_ = source_->beforeSwap(prepare);
  bool changed = false;
  models(&changed);
}

std::shared_ptr<const ModelDatabase> StageNodelet::models(bool* changed) {
  const auto present = source_->current();
  *changed = present != models_;
  if (*changed) {
    models_ = present;
    monitor_.setModels(static_cast<int>(present->database->objects.size()), present->errors);
  }
  return present->database;
}

std::shared_ptr<const ModelDatabase> StageNodelet::modelsAt(std::uint64_t revision) const {
  return source_->atRevision(revision)->database;
}

bool StageNodelet::reload(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  try {
    source_->reload();
    response.success = 1;
    response.message = std::to_string(source_->current()->database->objects.size()) + " models";
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

const std::vector<std::string>& StageNodelet::stageParameterNames() {
  static const std::vector<std::string> names = {"models", "lazy", "diagnostic_period"};
  return names;
}

}  // namespace recognition
