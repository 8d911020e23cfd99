#include "bags/bag_writer.h"

#include <stdexcept>

#include <rosbag/bag.h>

#include "ros/image_conversions.h"

namespace recognition {

class BagWriter::Impl {
 public:
  Impl(const std::string& file, const FrameTopics& topics, const std::string& frame_id)
      : file_(file),
        topics_{absolute(topics.color), absolute(topics.camera_info), absolute(topics.depth)},
        frame_id_(frame_id) {
    guarded([&] {
      bag_.open(file, rosbag::bagmode::Write);
      bag_.setCompression(rosbag::compression::BZ2);
    });
  }

  void write(const RgbdFrame& frame, std::int64_t stamp) {
    frame.validate();
    std_msgs::Header header;
    header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
    header.frame_id = frame_id_;
    const auto color = imageMessage(frame.color, header);
    if (frame.color_order == ColorOrder::kRgb) color->encoding = "rgb8";
    const auto depth = imageMessage(frame.depth, header);
    guarded([&] {
      bag_.write(topics_.color, header.stamp, color);
      bag_.write(topics_.camera_info, header.stamp, cameraInfo(frame.color_camera, header));
      bag_.write(topics_.depth, header.stamp, depth);
    });
  }

  void close() {
    guarded([&] { bag_.close(); });
  }

 private:
  static std::string absolute(const std::string& topic) {
    return !topic.empty() && topic[0] == '/' ? topic : "/" + topic;
  }

  template <typename Action>
  void guarded(const Action& action) {
    try {
      action();
    } catch (const std::exception& error) {
      throw std::runtime_error(file_ + ": " + error.what());
    }
  }

  std::string file_;
  FrameTopics topics_;
  std::string frame_id_;
  rosbag::Bag bag_;
};

BagWriter::BagWriter(const std::string& file, const FrameTopics& topics, const std::string& frame_id)
    : impl_(std::make_unique<Impl>(file, topics, frame_id)) {}
BagWriter::~BagWriter() = default;

void BagWriter::write(const RgbdFrame& frame, std::int64_t stamp) { impl_->write(frame, stamp); }
void BagWriter::close() { impl_->close(); }

}  // namespace recognition
