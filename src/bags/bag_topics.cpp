#include "bags/bag_topics.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

namespace recognition {
namespace {

/// What each part of a frame may be.
const std::set<std::string> kColorTypes = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};
const std::set<std::string> kInfoTypes = {"sensor_msgs/CameraInfo"};
const std::set<std::string> kDepthTypes = {"sensor_msgs/Image", "sensor_msgs/CompressedImage",
                                           "sensor_msgs/PointCloud2"};

/// Sets looked for in a bag whose topics were not given, each in any namespace: openni's (with image_raw for a camera
/// without calibration, which nothing rectifies), the challenge's (test and training), RealSense's, Azure's, TUM's.
const std::vector<FrameTopics>& knownTopics() {
  static const std::vector<FrameTopics> sets = {
      {"rgb/image_rect_color", "rgb/camera_info", "depth_registered/image_raw"},
      {"rgb/image_rect_color", "rgb/camera_info", "depth_registered/image_rect"},
      {"rgb/image_rect_color", "rgb/camera_info", "depth_registered/hw_registered/image_rect_raw"},
      {"rgb/image_rect_color", "rgb/camera_info", "depth_registered/sw_registered/image_rect_raw"},
      {"rgb/image_rect_color", "rgb/camera_info", "depth_registered/points"},
      {"rgb/image_raw", "rgb/camera_info", "depth_registered/image_raw"},
      {"rgb/image_color", "rgb/camera_info", "rgb/points"},
      {"image_color", "camera_info", "points"},
      {"image", "camera_info", "points2"},
      {"color/image_rect_color", "color/camera_info", "aligned_depth_to_color/image_raw"},
      {"color/image_raw", "color/camera_info", "aligned_depth_to_color/image_raw"},
      {"rgb/image_rect_color", "rgb/camera_info", "depth_to_rgb/image_raw"},
      {"rgb/image_raw", "rgb/camera_info", "depth_to_rgb/image_raw"},
      {"rgb/image_color", "rgb/camera_info", "depth_registered/image_raw"},
      {"rgb/image_color", "rgb/camera_info", "depth/image"}};
  return sets;
}

class TopicChooser {
 public:
  explicit TopicChooser(const BagFile& bag) {
    for (const auto& [id, connection] : bag.connections()) {
      types_[plainName(connection.topic)] = connection.type;
      listing_ += " " + connection.topic + " (" + connection.type + ")";
    }
    if (listing_.empty()) listing_ = " none";
  }

  FrameTopics wanted(const FrameTopics& topics) const {
    return {asked(topics.color, kColorTypes, {"/compressed"}), asked(topics.camera_info, kInfoTypes, {}),
            asked(topics.depth, kDepthTypes, {"/compressedDepth", "/compressed"})};
  }

  FrameTopics known() const {
    for (const FrameTopics& set : knownTopics()) {
      std::vector<FrameTopics> found;
      for (const std::string& space : namespacesOf(set.color)) {
        const FrameTopics topics = {find(space + set.color, kColorTypes, {"/compressed"}),
                                    find(space + set.camera_info, kInfoTypes, {}),
                                    find(space + set.depth, kDepthTypes, {"/compressedDepth", "/compressed"})};
        if (topics.color.empty() || topics.camera_info.empty() || topics.depth.empty()) continue;
        if (space == "camera/") return topics;
        found.push_back(topics);
      }
      if (found.size() > 1)
        throw std::runtime_error("holds several cameras, as " + found[0].color + " and " + found[1].color +
                                 "; choose one with --color-topic, --info-topic and --depth-topic");
      if (!found.empty()) return found.front();
    }
    requireInfo();
    throw std::runtime_error("holds none of the known sets of colour, camera info and depth topics; there are" +
                             listing_);
  }

 private:
  /// Says what is missing where there are known images without their camera.
  void requireInfo() const {
    for (const FrameTopics& set : knownTopics())
      for (const std::string& space : namespacesOf(set.color))
        if (find(space + set.camera_info, kInfoTypes, {}).empty() &&
            !find(space + set.depth, kDepthTypes, {"/compressedDepth", "/compressed"}).empty())
          throw std::runtime_error("holds no camera info for " + space + set.color + " (" + space + set.camera_info +
                                   "); record it, too; there are" + listing_);
  }

  /// "" if it is not there.
  std::string find(const std::string& topic, const std::set<std::string>& types,
                   const std::vector<std::string>& endings) const {
    if (const auto found = types_.find(topic); found != types_.end() && types.count(found->second)) return topic;
    for (const std::string& ending : endings)
      if (types_.count(topic + ending)) return topic + ending;
    return "";
  }

  std::string asked(const std::string& topic, const std::set<std::string>& types,
                    const std::vector<std::string>& endings) const {
    const std::string plain = plainName(topic), found = find(plain, types, endings);
    if (!found.empty()) return found;
    if (const auto other = types_.find(plain); other != types_.end())
      throw std::runtime_error("its topic '" + topic + "' is of type " + other->second + ", not " + *types.begin());
    throw std::runtime_error("holds no topic '" + plain + "'; there are" + listing_);
  }

  /// What stands in front of `ending` in the topics that end so, or so and compressed.
  std::set<std::string> namespacesOf(const std::string& ending) const {
    std::set<std::string> spaces;
    for (const auto& [topic, type] : types_)
      for (const std::string& whole : {ending, ending + "/compressed"}) {
        if (topic.size() < whole.size() || topic.compare(topic.size() - whole.size(), whole.size(), whole) != 0)
          continue;
        const std::string space = topic.substr(0, topic.size() - whole.size());
        if (space.empty() || space.back() == '/') spaces.insert(space);
      }
    return spaces;
  }

  std::map<std::string, std::string> types_;  // of the topics, by plain name
  std::string listing_;
};

}  // namespace

std::string plainName(const std::string& topic) { return !topic.empty() && topic[0] == '/' ? topic.substr(1) : topic; }

FrameTopics chooseTopics(const BagFile& bag, const std::optional<FrameTopics>& wanted) {
  const TopicChooser chooser(bag);
  return wanted ? chooser.wanted(*wanted) : chooser.known();
}

FrameTopics openniTopics() {
  return {"camera/rgb/image_rect_color", "camera/rgb/camera_info", "camera/depth_registered/image_raw"};
}

FrameTopics challengeTopics() { return {"camera/rgb/image_color", "camera/rgb/camera_info", "camera/rgb/points"}; }

}  // namespace recognition
