#include "bags/bag_reader.h"

#include <cstdio>
#include <cstdlib>
#include <deque>
#include <optional>
#include <stdexcept>
#include <vector>

#include "bags/bag_file.h"
#include "bags/bag_topics.h"
#include "bags/compressed_image.h"
#include "core/short_number.h"
#include "ros/image_conversions.h"

namespace recognition {
namespace {

constexpr size_t kMaxPending = 100;  // messages of one topic that wait for their partners

std::string milliseconds(std::int64_t nanoseconds) {
  return shortNumber(1e-6 * static_cast<double>(nanoseconds)) + " ms";
}

/// What is known of skipped images.
struct Skipped {
  int count = 0, without_info = 0, without_depth = 0;
  std::int64_t nearest = -1;  ///< of the depth beside them in time, nanoseconds; -1 if there was none
};

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

class BagReader::Impl {
 public:
  Impl(const std::string& file, const std::optional<FrameTopics>& topics, double max_interval)
      : file_(file), max_interval_(static_cast<std::int64_t>(max_interval * 1e9)), bag_(file) {
    try {
      topics_ = chooseTopics(bag_, topics);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(file + ": " + error.what());
    }
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
  int skipped() const { return skipped_.count; }

  std::string remarks() const {
    std::string text;
    if (undistorted_) text = "the images of " + topics_.color + " are not rectified; their distortion was undone";
    if (skipped_.count == 0) return text;
    text += (text.empty() ? "" : "; ") + std::to_string(skipped_.count) + " of " + std::to_string(color_images_) +
            " colour images were skipped";
    if (skipped_.without_info > 0) text += ", " + std::to_string(skipped_.without_info) + " without camera info";
    if (skipped_.without_depth > 0)
      text += ", " + std::to_string(skipped_.without_depth) + " without depth within " + milliseconds(max_interval_);
    if (skipped_.nearest >= 0)
      text += "; the nearest depth is " + milliseconds(skipped_.nearest) + " away (--max-interval " +
              shortNumber(1e-9 * static_cast<double>(skipped_.nearest) * 1.1) + " would take it)";
    return text;
  }

 private:
  std::string topicOf(const BagFile::Entry& entry) const { return plainName(bag_.connection(entry).topic); }

  void read(const BagFile::Entry& entry) {
    const std::string topic = topicOf(entry);
    if (topic == topics_.color) {
      if (const auto image = imageOf(entry, colorFromCompressed)) colors_.push_back(image);
    } else if (topic == topics_.camera_info) {
      if (const auto info = bag_.message<sensor_msgs::CameraInfo>(entry)) infos_.push(info);
    } else if (topic == topics_.depth) {
      if (const auto image = imageOf(entry, depthFromCompressed)) depths_.push(image);
      if (const auto cloud = bag_.message<sensor_msgs::PointCloud2>(entry)) clouds_.push(cloud);
    }
  }

  template <typename Decoder>
  sensor_msgs::ImageConstPtr imageOf(const BagFile::Entry& entry, const Decoder& decode) {
    const auto packed = bag_.message<sensor_msgs::CompressedImage>(entry);
    if (!packed) return bag_.message<sensor_msgs::Image>(entry);
    try {
      return decode(*packed);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file_ + ": " + topicOf(entry) + ": " + error.what());
    }
  }

  /// False if what comes later in the bag may fit better.
  bool findPartners(const sensor_msgs::ImageConstPtr& color, FrameMessages* messages) {
    const std::int64_t stamp = Pending<sensor_msgs::Image>::stampOf(color);
    const std::int64_t from = stamp - max_interval_, to = stamp + max_interval_;
    depths_.dropBefore(from, 1);  // the last one, to tell how far away it is
    clouds_.dropBefore(from, 1);
    infos_.dropBefore(from, 1);  // the last one counts until another comes
    const auto depth = depths_.nearest(stamp);
    const auto cloud = clouds_.nearest(stamp);
    const auto info = infos_.nearest(stamp);
    const bool exact = (isAt(depth, stamp) || isAt(cloud, stamp)) && isAt(info, stamp);
    const bool passed = (depths_.reached(to) || clouds_.reached(to)) && infos_.reached(stamp);
    if (!exact && !passed && !at_end_ && colors_.size() < kMaxPending && !depths_.full() && !clouds_.full())
      return false;
    *messages = {color, nullptr, info};
    nearest_ = -1;
    if (depth) nearest_ = std::llabs(depths_.stampOf(depth) - stamp);
    if (cloud) nearest_ = std::llabs(clouds_.stampOf(cloud) - stamp);
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
      skip(messages.camera_info != nullptr);
      return false;
    }
    try {
      if (cloud) messages.depth = depthFromPoints(*cloud);
      messages.color = colorWithThreeChannels(messages.color);
      const auto owner = std::make_shared<FrameMessages>(messages);
      *frame = {rectifiedView(*owner), static_cast<std::int64_t>(owner->color->header.stamp.toNSec()),
                owner->color->header.frame_id, owner};
    } catch (const std::invalid_argument& error) {
      char stamp[32];
      std::snprintf(stamp, sizeof stamp, "%.3f", messages.color->header.stamp.toSec());
      throw std::runtime_error(file_ + ": frame at " + stamp + " s: " + error.what());
    }
    return true;
  }

  void skip(bool has_info) {
    ++skipped_.count;
    ++(has_info ? skipped_.without_depth : skipped_.without_info);
    if (has_info && nearest_ >= 0 && (skipped_.nearest < 0 || nearest_ < skipped_.nearest)) skipped_.nearest = nearest_;
  }

  RgbdFrame rectifiedView(const FrameMessages& messages) {
    if (isRectified(topics_.color)) return frameView(messages);
    const Distortion distortion = distortionOf(*messages.camera_info);
    if (!distortion.isThere()) return frameView(messages);
    const RgbdFrame frame = undistortedFrame(messages, isRectified(topics_.depth));
    undistorted_ = true;
    return frame;
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
  std::int64_t nearest_ = -1;  // of the depth to the colour image being decided, nanoseconds
  int color_images_ = 0;
  Skipped skipped_;
  bool undistorted_ = false;
};

BagReader::BagReader(const std::string& file, const FrameTopics& topics, double max_interval)
    : impl_(std::make_unique<Impl>(file, topics, max_interval)) {}
BagReader::BagReader(const std::string& file, double max_interval)
    : impl_(std::make_unique<Impl>(file, std::nullopt, max_interval)) {}
BagReader::~BagReader() = default;

bool BagReader::next(RecordedFrame* frame) { return impl_->next(frame); }
int BagReader::colorImages() const { return impl_->colorImages(); }
int BagReader::skipped() const { return impl_->skipped(); }
std::string BagReader::remarks() const { return impl_->remarks(); }

}  // namespace recognition
