#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include <dynamic_reconfigure/server.h>

namespace recognition {

/// The ranges of a .cfg, without dynamic_reconfigure's habit of moving values that are out of range into it without a
/// word, before anybody sees them: its own limits are widened, and its servers are given the ranges only to tell them
/// to their clients.
template <typename Config>
class ConfigRanges {
 public:
  /// To be called before a server is made.
  static const ConfigRanges& get() {
    static const ConfigRanges ranges;
    return ranges;
  }

  void giveTo(dynamic_reconfigure::Server<Config>& server) const {
    server.setConfigMin(min_);
    server.setConfigMax(max_);
  }

  /// Throws std::invalid_argument that names the first value out of range.
  void require(const Config& config) const {
    dynamic_reconfigure::Config values, low, high;
    config.__toMessage__(values);
    min_.__toMessage__(low);
    max_.__toMessage__(high);
    requireAll(values.ints, low.ints, high.ints);
    requireAll(values.doubles, low.doubles, high.doubles);
  }

 private:
  ConfigRanges() : min_(Config::__getMin__()), max_(Config::__getMax__()) {
    widen(Config::__getMin__(), std::numeric_limits<int>::lowest(), std::numeric_limits<double>::lowest());
    widen(Config::__getMax__(), std::numeric_limits<int>::max(), std::numeric_limits<double>::max());
  }

  static void widen(const Config& limits, int whole, double number) {
    dynamic_reconfigure::Config message;
    limits.__toMessage__(message);
    for (auto& item : message.ints) item.value = whole;
    for (auto& item : message.doubles) item.value = number;
    const_cast<Config&>(limits).__fromMessage__(message);  // not made const, only handed out so
  }

  template <typename Items>
  static void requireAll(const Items& values, const Items& low, const Items& high) {
    for (size_t i = 0; i < values.size(); ++i)
      if (!(values[i].value >= low[i].value && values[i].value <= high[i].value))
        throw std::invalid_argument(values[i].name + " is " + std::to_string(values[i].value) + ": must be in [" +
                                    std::to_string(low[i].value) + ", " + std::to_string(high[i].value) + "]");
  }

  const Config min_, max_;
};

}  // namespace recognition
