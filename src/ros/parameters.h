#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <dynamic_reconfigure/Config.h>
#include <ros/node_handle.h>

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// Sets `parameters` from the node handle's namespace; those not there keep their values. Throws std::invalid_argument
/// that names the key and what is wrong: a type that does not fit, a value out of range, or a name that is neither in
/// `parameters` nor in `others` (names a nodelet reads beside its core's).
void readParameters(const ros::NodeHandle& node, const ParameterList& parameters,
                    const std::vector<std::string>& others);

/// One required or optional value with its type and range checked in the same way.
std::string requiredString(const ros::NodeHandle& node, const std::string& name);
double numberInRange(const ros::NodeHandle& node, const std::string& name, double standard, double min, double max);

/// The value, or `standard` where it is not set. Throws std::invalid_argument naming a key of another type.
template <typename Value>
Value parameterOr(const ros::NodeHandle& node, const std::string& name, const Value& standard) {
  Value value = standard;
  if (node.hasParam(name) && !node.getParam(name, value))
    throw std::invalid_argument(node.resolveName(name) + " has a wrong type");
  return value;
}

/// Between our lists and what dynamic_reconfigure sends. applyConfig throws std::invalid_argument as readParameters
/// does.
void applyConfig(const dynamic_reconfigure::Config& config, const ParameterList& parameters, const std::string& group);
dynamic_reconfigure::Config configMessage(const ParameterList& parameters);

}  // namespace recognition
