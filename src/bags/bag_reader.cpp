#include "bags/bag_reader.h"

#include <cstdlib>
#include <deque>
#include <optional>
#include <stdexcept>
#include <vector>

#include "bags/bag_file.h"
#include "rgbd_recognition/ros/image_conversions.h"

namespace recognition {
namespace {

constexpr size_t kMaxPending = 100;  // messages of one topic that wait for their partners

std::string plainName(const std::string& topic) { return !topic.empty() && topic[0] == '/' ? topic.substr(1) : topic; }

/// Sets looked for in a bag whose topics were not given: openni's (the last for a camera without calibration, which
/// nothing rectifies), the challenge's (test and training), RealSense's, Azure's.
std::vector<FrameTopics> knownTopics() {
  const std::string rgb = "camera/rgb/", color = "camera/color/";
  return {openniTopics(),
          {rgb + "image_rect_color", rgb + "camera_info", "camera/depth_registered/image_rect"},
          {rgb + "image_rect_color", rgb + "camera_info", "camera/depth_registered/points"},
          {rgb + "image_raw", rgb + "camera_info", "camera/depth_registered/image_raw"},
          challengeTopics(),
          {"image_color", "camera_info", "points"},
          {"image", "camera_info", "points2"},
          {color + "image_raw", color + "camera_info", "camera/aligned_depth_to_color/image_raw"},
          {"rgb/image_raw", "rgb/camera_info", "depth_to_rgb/image_raw"}};
}

/// Messages of one topic in order of arrival, with the nearest to a stamp.
template <typename Message>
class Pending {
 public:
  void push(const boost::shared_ptr<const Message>& message) {
    if (full()) messages_.pop_front();  // no colour waits for it, or it would not be full
    messages_.push_back(message);
  }
  void dropBefore(std::int64_t stamp, size_t keep = 0) {
    while (messages_.size() > keep && stampOf(messages_.front()) < stamp) messages_.pop_front();
  }
  bool reached(std::int64_t stamp) const { return !messages_.empty() && stampOf(messages_.back()) >= stamp; }
  bool full() const { return messages_.size() >= kMaxPending; }
  boost::shared_ptr<const Message> nearest(std::int64_t stamp) const {
    boost::shared_ptr<const Message> best;
    for (const auto& message : messages_)
      if (!best || std::llabs(stampOf(message) - stamp) < std::llabs(stampOf(best) - stamp)) best = message;
    return best;
  }
  static std::int64_t stampOf(const boost::shared_ptr<const Message>& message) {
    return static_cast<std::int64_t>(message->header.stamp.toNSec());
  }

 private:
  std::deque<boost::shared_ptr<const Message>> messages_;
};

}  // namespace

FrameTopics openniTopics() {
  return {"camera/rgb/image_rect_color", "camera/rgb/camera_info", "camera/depth_registered/image_raw"};
}

FrameTopics challengeTopics() { return {"camera/rgb/image_color", "camera/rgb/camera_info", "camera/rgb/points"}; }

class BagReader::Impl {
 public:
  Impl(const std::string& file, const std::optional<FrameTopics>& topics, double max_interval)
      : file_(file), max_interval_(static_cast<std::int64_t>(max_interval * 1e9)), bag_(file) {
    choose(topics ? std::vector<FrameTopics>{*topics} : knownTopics());
    for (const BagFile::Entry& entry : bag_.entries()) color_images_ += topicOf(entry) == topics_.color;
  }

  bool next(RecordedFrame* frame) {
    for (;;) {
      while (!colors_.empty()) {
        const sensor_msgs::ImageConstPtr color = colors_.front();
        FrameMessages messages;
        if (!findPartners(color, &messages)) break;
        colors_.pop_front();
        if (fill(messages, frame)) return true;
      }
      if (next_ == bag_.entries().size()) {
        if (colors_.empty()) return false;
        at_end_ = true;
      } else {
        read(bag_.entries()[next_++]);
      }
    }
  }

  int colorImages() const { return color_images_; }
  int skipped() const { return skipped_; }

 private:
  void choose(const std::vector<FrameTopics>& sets) {
    std::string problem;
    for (const FrameTopics& set : sets) {
      topics_ = {plainName(set.color), plainName(set.camera_info), plainName(set.depth)};
      problem.clear();
      for (const std::string* topic : {&topics_.color, &topics_.camera_info, &topics_.depth})
        if (problem.empty() && !holds(*topic)) problem = "holds no topic '" + *topic + "'";
      if (problem.empty()) return;
    }
    if (sets.size() > 1) problem = "holds none of the known sets of colour, camera info and depth topics";
    std::string names;
    for (const auto& [id, connection] : bag_.connections())
      names += " " + connection.topic + " (" + connection.type + ")";
    throw std::runtime_error(file_ + ": " + problem + "; there are" + (names.empty() ? " none" : names));
  }

  bool holds(const std::string& topic) const {
    for (const auto& [id, connection] : bag_.connections())
      if (plainName(connection.topic) == topic) return true;
    return false;
  }

  std::string topicOf(const BagFile::Entry& entry) const { return plainName(bag_.connection(entry).topic); }

  void read(const BagFile::Entry& entry) {
    const std::string topic = topicOf(entry);
    if (topic == topics_.color) {
      if (const auto image = bag_.message<sensor_msgs::Image>(entry)) colors_.push_back(image);
    } else if (topic == topics_.camera_info) {
      if (const auto info = bag_.message<sensor_msgs::CameraInfo>(entry)) infos_.push(info);
    } else if (topic == topics_.depth) {
      if (const auto image = bag_.message<sensor_msgs::Image>(entry)) depths_.push(image);
      if (const auto cloud = bag_.message<sensor_msgs::PointCloud2>(entry)) clouds_.push(cloud);
    }
  }

  /// False if what comes later in the bag may fit better.
  bool findPartners(const sensor_msgs::ImageConstPtr& color, FrameMessages* messages) {
    const std::int64_t stamp = Pending<sensor_msgs::Image>::stampOf(color);
    const std::int64_t from = stamp - max_interval_, to = stamp + max_interval_;
    depths_.dropBefore(from);
    clouds_.dropBefore(from);
    infos_.dropBefore(from, 1);  // the last one counts until another comes
    const auto depth = depths_.nearest(stamp);
    const auto cloud = clouds_.nearest(stamp);
    const auto info = infos_.nearest(stamp);
    const bool exact = (isAt(depth, stamp) || isAt(cloud, stamp)) && isAt(info, stamp);
    const bool passed = (depths_.reached(to) || clouds_.reached(to)) && infos_.reached(stamp);
    if (!exact && !passed && !at_end_ && colors_.size() < kMaxPending && !depths_.full() && !clouds_.full())
      return false;
    *messages = {color, nullptr, info};
    if (depth && std::llabs(depths_.stampOf(depth) - stamp) <= max_interval_) messages->depth = depth;
    if (cloud && std::llabs(clouds_.stampOf(cloud) - stamp) <= max_interval_) cloud_ = cloud;
    return true;
  }

  template <typename Message>
  static bool isAt(const boost::shared_ptr<const Message>& message, std::int64_t stamp) {
    return message && Pending<Message>::stampOf(message) == stamp;
  }

  bool fill(FrameMessages messages, RecordedFrame* frame) {
    const sensor_msgs::PointCloud2ConstPtr cloud = std::move(cloud_);
    cloud_ = nullptr;
    if ((!messages.depth && !cloud) || !messages.camera_info) {
      ++skipped_;
      return false;
    }
    try {
      if (cloud) messages.depth = depthFromPoints(*cloud);
      const auto owner = std::make_shared<FrameMessages>(messages);
      *frame = {frameView(*owner), static_cast<std::int64_t>(owner->color->header.stamp.toNSec()),
                owner->color->header.frame_id, owner};
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file_ + ": frame at " + std::to_string(messages.color->header.stamp.toSec()) +
                               " s: " + error.what());
    }
    return true;
  }

  std::string file_;
  std::int64_t max_interval_;
  BagFile bag_;
  size_t next_ = 0;  // of the bag's entries
  FrameTopics topics_;
  std::deque<sensor_msgs::ImageConstPtr> colors_;
  Pending<sensor_msgs::Image> depths_;
  Pending<sensor_msgs::PointCloud2> clouds_;
  Pending<sensor_msgs::CameraInfo> infos_;
  sensor_msgs::PointCloud2ConstPtr cloud_;  // partner of the colour image being decided
  bool at_end_ = false;
  int color_images_ = 0;
  int skipped_ = 0;
};

BagReader::BagReader(const std::string& file, const FrameTopics& topics, double max_interval)
    : impl_(std::make_unique<Impl>(file, topics, max_interval)) {}
BagReader::BagReader(const std::string& file) : impl_(std::make_unique<Impl>(file, std::nullopt, 0.02)) {}
BagReader::~BagReader() = default;

bool BagReader::next(RecordedFrame* frame) { return impl_->next(frame); }
int BagReader::colorImages() const { return impl_->colorImages(); }
int BagReader::skipped() const { return impl_->skipped(); }

}  // namespace recognition
