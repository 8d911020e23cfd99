/// Brings back nodelets that a manager lost: watch_nodelets <manager> <nodelet>...
///
/// When a manager dies, the `nodelet load` of each of its nodelets should notice by its bond, end, and be started
/// again by roslaunch. One that was loaded a second before does not: bond (1.8.6) starts its time-out at the second
/// heartbeat, not at the first, so a manager that dies in between is waited for without end, and the nodelet stays
/// missing in the new one. This node compares what the manager has with what it had, and ends a `nodelet load` that
/// outlives its nodelet. Names of nodelets that are never loaded do no harm.

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

/// The `nodelet load` of one nodelet, which has the nodelet's name.
class Loader {
 public:
  explicit Loader(const std::string& name) : name_(name) {}

  void look(const std::vector<std::string>& present) {
    if (std::find(present.begin(), present.end(), name_) != present.end()) {
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

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "watch_nodelets");
  if (argc < 3) {
    ROS_FATAL("usage: watch_nodelets <manager> <nodelet>...");
    return 2;
  }
  const ros::NodeHandle node;
  const std::string list = node.resolveName(argv[1]) + "/list";
  std::vector<Loader> loaders;
  for (int i = 2; i < argc; ++i) loaders.emplace_back(node.resolveName(argv[i]));
  while (ros::ok()) {
    nodelet::NodeletList answer;
    if (!ros::service::call(list, answer)) answer.response.nodelets.clear();  // no manager
    for (Loader& loader : loaders) loader.look(answer.response.nodelets);
    kPeriod.sleep();
  }
  return 0;
}
