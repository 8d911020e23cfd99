#include "bags/bag_writer.h"

#include <limits>
#include <stdexcept>

#include <rosbag/bag.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_msgs/TFMessage.h>

#include "ros/image_conversions.h"
#include "ros/message_conversions.h"

namespace recognition {
namespace {

sensor_msgs::PointCloud2 organisedCloud(const RgbdFrame& frame, const std_msgs::Header& header) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header = header;
  cloud.is_dense = false;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(frame.depth.total());
  cloud.width = static_cast<std::uint32_t>(frame.depth.cols);
  cloud.height = static_cast<std::uint32_t>(frame.depth.rows);
  cloud.row_step = cloud.width * cloud.point_step;
  const cv::Mat depth = depthInMetres(frame.depth), color = bgrCopy(frame);
  const CameraModel camera = frame.depthCamera();
  const int k = frame.colorPerDepthPixel();
  sensor_msgs::PointCloud2Iterator<float> xyz(cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> bgr(cloud, "rgb");
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u, ++xyz, ++bgr) {
      const float z = depth.at<float>(v, u);
      const Eigen::Vector3d point = camera.unproject(u, v, z > 0.0f ? z : std::numeric_limits<double>::quiet_NaN());
      const auto& pixel = color.at<cv::Vec3b>(k * v, k * u);
      for (int c = 0; c < 3; ++c) {
        xyz[c] = static_cast<float>(point[c]);
        bgr[c] = pixel[c];
      }
    }
  return cloud;
}

}  // namespace

class BagWriter::Impl {
 public:
  Impl(const std::string& file, const FrameTopics& topics, const BagForm& form)
      : file_(file),
        topics_{absolute(topics.color), absolute(topics.camera_info), absolute(topics.depth)},
        form_(form) {
    guarded([&] {
      bag_.open(file, rosbag::bagmode::Write);
      bag_.setCompression(form.fast ? rosbag::compression::LZ4 : rosbag::compression::BZ2);
    });
  }

  void write(const RgbdFrame& frame, std::int64_t stamp) {
    frame.validate();
    const std_msgs::Header header = headerAt(stamp);
    const auto color = imageMessage(frame.color, header);
    if (frame.color_order == ColorOrder::kRgb) color->encoding = "rgb8";
    guarded([&] {
      bag_.write(topics_.color, header.stamp, color);
      bag_.write(topics_.camera_info, header.stamp, cameraInfo(frame.color_camera, header));
      if (form_.depth_as_cloud)
        bag_.write(topics_.depth, header.stamp, organisedCloud(frame, header));
      else
        bag_.write(topics_.depth, header.stamp, imageMessage(frame.depth, header));
    });
  }

  void writePoses(const std::map<std::string, Pose>& camera_from_objects, std::int64_t stamp) {
    const std_msgs::Header header = headerAt(stamp);
    tf2_msgs::TFMessage message;
    for (const auto& [frame, pose] : camera_from_objects)
      message.transforms.push_back(transformMessage(poseMessage(pose), header, frame));
    guarded([&] { bag_.write("/tf", header.stamp, message); });
  }

  void close() {
    guarded([&] { bag_.close(); });
  }

 private:
  static std::string absolute(const std::string& topic) {
    return !topic.empty() && topic[0] == '/' ? topic : "/" + topic;
  }

  std_msgs::Header headerAt(std::int64_t stamp) const {
    std_msgs::Header header;
    header.stamp.fromNSec(static_cast<std::uint64_t>(stamp));
    header.frame_id = form_.frame_id;
    return header;
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
  BagForm form_;
  rosbag::Bag bag_;
};

BagWriter::BagWriter(const std::string& file, const FrameTopics& topics, const BagForm& form)
    : impl_(std::make_unique<Impl>(file, topics, form)) {}
BagWriter::~BagWriter() = default;

void BagWriter::write(const RgbdFrame& frame, std::int64_t stamp) { impl_->write(frame, stamp); }
void BagWriter::writePoses(const std::map<std::string, Pose>& camera_from_objects, std::int64_t stamp) {
  impl_->writePoses(camera_from_objects, stamp);
}
void BagWriter::close() { impl_->close(); }

}  // namespace recognition
