#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <dynamic_reconfigure/server.h>
#include <ros/console.h>

#include "ros/config_ranges.h"
#include "ros/parameters.h"

namespace recognition {

/// The parameters of one stage: read at start, changed by dynamic_reconfigure. `Parameters` is the core's struct,
/// `Config` is generated from the .cfg made of its list.
template <typename Config, typename Parameters>
class Reconfigurable {
 public:
  /// Reads and checks all and hands them to `use`. Throws std::invalid_argument that names the key.
  void read(const ros::NodeHandle& private_node, const std::vector<std::string>& other_names,
            const std::function<void(const Parameters&)>& use) {
    use_ = use;
    group_ = private_node.getNamespace();
    Parameters parameters;
    readParameters(private_node, parameters.list(), other_names);
    parameters.validate();
    use_(parameters);
    current_ = parameters;
  }

  /// Serves changes: each makes `use` build its core object anew; a set that is refused by list (a value out of range),
  /// validate() or `use` leaves the last good one, and the log says why.
  void serve(const ros::NodeHandle& private_node) {
    const auto& ranges = ConfigRanges<Config>::get();
    server_ = std::make_unique<dynamic_reconfigure::Server<Config>>(mutex_, private_node);
    ranges.giveTo(*server_);
    dynamic_reconfigure::Config message = configMessage(current_.list());
    Config config = Config::__getDefault__();
    config.__fromMessage__(message);
    server_->updateConfig(config);  // the core's defaults count, not those of the .cfg
    server_->setCallback([this](Config& config, std::uint32_t) { change(config); });
  }

  const Parameters& current() const { return current_; }

 private:
  void change(Config& config) {
    dynamic_reconfigure::Config message;
    config.__toMessage__(message);
    Parameters wanted = current_;
    try {
      applyConfig(message, wanted.list(), group_);
      wanted.validate();
      if (!sameValues(wanted, current_)) use_(wanted);
      current_ = wanted;
    } catch (const std::exception& error) {
      ROS_ERROR("%s", error.what());
      message = configMessage(current_.list());
      config.__fromMessage__(message);
    }
  }

  static bool sameValues(Parameters& a, Parameters& b) {
    const ParameterList left = a.list(), right = b.list();
    for (size_t i = 0; i < left.size(); ++i)
      if (valueText(left[i]) != valueText(right[i])) return false;
    return true;
  }

  std::function<void(const Parameters&)> use_;
  std::string group_;
  Parameters current_;
  boost::recursive_mutex mutex_;
  std::unique_ptr<dynamic_reconfigure::Server<Config>> server_;
};

}  // namespace recognition
