/// Brings back nodelets that a manager lost: watch_nodelets <manager> <nodelet>...
///
/// When a manager dies, the `nodelet load` of each of its nodelets should notice by its bond, end, and be started
/// again by roslaunch. One that was loaded a second before does not: bond (1.8.6) starts its time-out at the second
/// heartbeat, not at the first, so a manager that dies in between is waited for without end, and the nodelet stays
/// missing in the new one. This node compares what the manager has with what it had, and ends a `nodelet load` that
/// outlives its nodelet. Names of nodelets that are never loaded do no harm.
///
/// watch_nodelets --start <manager> <nodelet>... ends with 1 as soon as one of them refused to start: its
/// `nodelet load` ended without it. Required in a launch file, it ends that, instead of leaving an idle manager.

#include <nodelet/NodeletList.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <string>
#include <vector>

namespace {

const ros::WallDuration kPeriod(0.5);
const ros::WallDuration kPatience(8.0);  // a bond takes four seconds to break
const ros::WallDuration kStartPeriod(0.1), kStartPatience(30.0);

/// Where a node is reached; empty if the master knows none of that name.
std::string addressOf(const std::string& node) {
  XmlRpc::XmlRpcValue arguments, response, address;
  arguments[0] = ros::this_node::getName();
  arguments[1] = node;
  return ros::master::execute("lookupNode", arguments, response, address, false) ? std::string(address) : "";
}

void shutDown(const std::string& address) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(address, host, port)) return;
  XmlRpc::XmlRpcValue arguments, response;
  arguments[0] = ros::this_node::getName();
  arguments[1] = "the manager has lost its nodelet";
  XmlRpc::XmlRpcClient(host.c_str(), static_cast<int>(port), "/").execute("shutdown", arguments, response);
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The `nodelet load` of one nodelet, which has the nodelet's name.
class Loader {
 public:
  explicit Loader(const std::string& name) : name_(name) {}

  void look(const std::vector<std::string>& present) {
    if (contains(present, name_)) {
      address_ = addressOf(name_);
      missing_since_ = ros::WallTime();
      return;
    }
    if (address_.empty()) return;  // not loaded yet, or being loaded again
    if (missing_since_.isZero()) missing_since_ = ros::WallTime::now();
    if (ros::WallTime::now() - missing_since_ < kPatience) return;
    if (addressOf(name_) == address_) {
      ROS_WARN("%s has outlived its nodelet; it is ended, to be started again", name_.c_str());
      shutDown(address_);
    }
    address_.clear();
    missing_since_ = ros::WallTime();
  }

 private:
  const std::string name_;
  std::string address_;  // when the manager had the nodelet last
  ros::WallTime missing_since_;
};

/// One nodelet on its way into the manager.
class Start {
 public:
  explicit Start(const std::string& name) : name_(name) {}

  /// True if it refused to start: there was a `nodelet load`, and there is none any more, but no nodelet either.
  bool refused(const std::vector<std::string>& present) {
    loaded_ = loaded_ || contains(present, name_);
    if (loaded_) return false;
    const bool is_there = !addressOf(name_).empty();
    seen_ = seen_ || is_there;
    if (is_there) gone_since_ = ros::WallTime();
    if (!is_there && gone_since_.isZero()) gone_since_ = ros::WallTime::now();
    return !is_there && ros::WallTime::now() - gone_since_ > (seen_ ? ros::WallDuration(1.0) : kStartPatience);
  }

  bool loaded() const { return loaded_; }
  const std::string& name() const { return name_; }

 private:
  const std::string name_;
  bool loaded_ = false, seen_ = false;
  ros::WallTime gone_since_;
};

std::vector<std::string> nodeletsOf(const std::string& list) {
  nodelet::NodeletList answer;
  if (!ros::service::call(list, answer)) answer.response.nodelets.clear();  // no manager
  return answer.response.nodelets;
}

int watchStart(const std::string& list, const std::vector<std::string>& names) {
  std::vector<Start> starts(names.begin(), names.end());
  ros::service::waitForService(list);
  while (ros::ok()) {
    const auto present = nodeletsOf(list);
    bool all = true;
    for (Start& start : starts) {
      const bool refused = start.refused(present);
      all = all && start.loaded();
      if (!refused) continue;
      ROS_FATAL("%s refused to start: the reason stands in its FATAL line above", start.name().c_str());
      return 1;
    }
    if (all) break;
    kStartPeriod.sleep();
  }
  ros::waitForShutdown();
  return 0;
}

int watchLosses(const std::string& list, const std::vector<std::string>& names) {
  std::vector<Loader> loaders(names.begin(), names.end());
  while (ros::ok()) {
    const auto present = nodeletsOf(list);
    for (Loader& loader : loaders) loader.look(present);
    kPeriod.sleep();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "watch_nodelets");
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool at_start = !arguments.empty() && arguments.front() == "--start";
  if (at_start) arguments.erase(arguments.begin());
  if (arguments.size() < 2) {
    ROS_FATAL("usage: watch_nodelets [--start] <manager> <nodelet>...");
    return 2;
  }
  const ros::NodeHandle node;
  std::vector<std::string> names;
  for (const std::string& argument : arguments) names.push_back(node.resolveName(argument));
  const std::string list = names.front() + "/list";
  names.erase(names.begin());
  return at_start ? watchStart(list, names) : watchLosses(list, names);
}
