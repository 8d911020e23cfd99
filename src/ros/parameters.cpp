#include "ros/parameters.h"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

#include <XmlRpcValue.h>

namespace recognition {
namespace {

using XmlRpc::XmlRpcValue;

std::string exactText(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(std::numeric_limits<double>::max_digits10) << value;
  return text.str();
}

const char* typeName(XmlRpcValue::Type type) {
  switch (type) {
    case XmlRpcValue::TypeBoolean:
      return "a boolean";
    case XmlRpcValue::TypeInt:
      return "a whole number";
    case XmlRpcValue::TypeDouble:
      return "a number";
    case XmlRpcValue::TypeString:
      return "a string";
    case XmlRpcValue::TypeArray:
      return "a list";
    default:
      return "of a strange type";
  }
}

[[noreturn]] void rejectType(const std::string& key, XmlRpcValue::Type is, const char* needed) {
  throw std::invalid_argument(key + " is " + typeName(is) + ", must be " + needed);
}

double numberFrom(XmlRpcValue value, const std::string& key) {
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(value);
  if (value.getType() != XmlRpcValue::TypeDouble) rejectType(key, value.getType(), "a number");
  return static_cast<double>(value);
}

std::string textFrom(const Parameter& parameter, XmlRpcValue value, const std::string& key) {
  const XmlRpcValue::Type type = value.getType();
  if (std::holds_alternative<bool*>(parameter.value)) {
    if (type != XmlRpcValue::TypeBoolean) rejectType(key, type, "true or false");
    return static_cast<bool>(value) ? "true" : "false";
  }
  if (std::holds_alternative<int*>(parameter.value)) {
    if (type != XmlRpcValue::TypeInt) rejectType(key, type, "a whole number");
    return std::to_string(static_cast<int>(value));
  }
  if (std::holds_alternative<double*>(parameter.value)) return exactText(numberFrom(value, key));
  if (type != XmlRpcValue::TypeString) rejectType(key, type, "a string");
  return static_cast<std::string>(value);
}

}  // namespace

void readParameters(const ros::NodeHandle& node, const ParameterList& parameters,
                    const std::vector<std::string>& others) {
  const std::string group = node.getNamespace();
  XmlRpcValue values;
  if (!node.getParam(group, values)) return;
  if (values.getType() != XmlRpcValue::TypeStruct) rejectType(group, values.getType(), "a map of parameters");
  for (auto& [name, value] : values) {
    const std::string key = name;
    const auto found =
        std::find_if(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.name == key; });
    const bool foreign = value.getType() == XmlRpcValue::TypeStruct;  // e.g. of an image_transport plug-in
    if (found != parameters.end()) {
      setFromText(*found, textFrom(*found, value, group + "/" + key), group);
    } else if (!foreign && std::find(others.begin(), others.end(), key) == others.end()) {
      throw std::invalid_argument(group + "/" + key + " is no known parameter");
    }
  }
}

std::string requiredString(const ros::NodeHandle& node, const std::string& name) {
  const std::string key = node.resolveName(name);
  XmlRpcValue value;
  if (!node.getParam(name, value)) throw std::invalid_argument(key + " is not set");
  if (value.getType() != XmlRpcValue::TypeString) rejectType(key, value.getType(), "a string");
  return static_cast<std::string>(value);
}

double numberInRange(const ros::NodeHandle& node, const std::string& name, double standard, double min, double max) {
  XmlRpcValue value;
  if (!node.getParam(name, value)) return standard;
  const std::string key = node.resolveName(name);
  const double number = numberFrom(value, key);
  if (!(number >= min && number <= max))
    throw std::invalid_argument(key + " is " + exactText(number) + ": must be in [" + exactText(min) + ", " +
                                exactText(max) + "]");
  return number;
}

void applyConfig(const dynamic_reconfigure::Config& config, const ParameterList& parameters, const std::string& group) {
  const auto set = [&](const std::string& name, const std::string& text) {
    for (const Parameter& parameter : parameters)
      if (parameter.name == name) setFromText(parameter, text, group);
  };
  for (const auto& item : config.bools) set(item.name, item.value ? "true" : "false");
  for (const auto& item : config.ints) set(item.name, std::to_string(item.value));
  for (const auto& item : config.doubles) set(item.name, exactText(item.value));
  for (const auto& item : config.strs) set(item.name, item.value);
}

dynamic_reconfigure::Config configMessage(const ParameterList& parameters) {
  const auto named = [](auto item, const std::string& name, auto value) {
    item.name = name;
    item.value = value;
    return item;
  };
  dynamic_reconfigure::Config config;
  for (const Parameter& p : parameters) {
    if (const auto* b = std::get_if<bool*>(&p.value))
      config.bools.push_back(named(dynamic_reconfigure::BoolParameter(), p.name, **b));
    if (const auto* i = std::get_if<int*>(&p.value))
      config.ints.push_back(named(dynamic_reconfigure::IntParameter(), p.name, **i));
    if (const auto* d = std::get_if<double*>(&p.value))
      config.doubles.push_back(named(dynamic_reconfigure::DoubleParameter(), p.name, **d));
    if (const auto* c = std::get_if<ChoiceAccess>(&p.value))
      config.strs.push_back(
          named(dynamic_reconfigure::StrParameter(), p.name, p.choices.at(static_cast<size_t>(c->get()))));
  }
  return config;
}

}  // namespace recognition
