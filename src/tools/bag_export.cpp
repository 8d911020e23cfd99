#include "tools/bag_export.h"

#include <rosbag/bag.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_msgs/TFMessage.h>

#include <limits>
#include <stdexcept>

#include "rgbd_recognition/evaluation/bop_dataset.h"
#include "bags/bag_reader.h"
#include "ros/image_conversions.h"
#include "ros/message_conversions.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

const char* const kFrameId = "camera_rgb_optical_frame";

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
  const CameraModel camera = frame.depthCamera();
  const int k = frame.colorPerDepthPixel();
  sensor_msgs::PointCloud2Iterator<float> xyz(cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> bgr(cloud, "rgb");
  for (int v = 0; v < frame.depth.rows; ++v)
    for (int u = 0; u < frame.depth.cols; ++u, ++xyz, ++bgr) {
      const float z = frame.depth.at<float>(v, u);
      const Eigen::Vector3d point = camera.unproject(u, v, z > 0.0f ? z : std::numeric_limits<double>::quiet_NaN());
      const auto& color = frame.color.at<cv::Vec3b>(k * v, k * u);
      for (int c = 0; c < 3; ++c) {
        xyz[c] = static_cast<float>(point[c]);
        bgr[c] = color[c];
      }
    }
  return cloud;
}

tf2_msgs::TFMessage transforms(const std::vector<GroundTruth>& objects, const std_msgs::Header& header) {
  tf2_msgs::TFMessage message;
  for (const GroundTruth& object : objects)
    message.transforms.push_back(
        transformMessage(poseMessage(object.camera_from_object), header, "obj_" + sixDigits(object.object_id)));
  return message;
}

std::string absolute(const std::string& topic) { return topic.front() == '/' ? topic : "/" + topic; }

void writeFrame(rosbag::Bag& bag, const FrameTopics& topics, bool cloud, const BopFrame& entry,
                const ros::Time& stamp) {
  RgbdFrame frame = loadBopFrame(entry);
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = kFrameId;
  bag.write(absolute(topics.color), stamp, imageMessage(frame.color, header));
  bag.write(absolute(topics.camera_info), stamp, cameraInfo(frame.color_camera, header));
  if (cloud) {
    bag.write(absolute(topics.depth), stamp, organisedCloud(frame, header));
  } else {
    cv::Mat millimetres;
    frame.depth.convertTo(millimetres, CV_16U, 1000.0);
    bag.write(absolute(topics.depth), stamp, imageMessage(millimetres, header));
  }
  if (!entry.ground_truth.empty()) bag.write("/tf", stamp, transforms(entry.ground_truth, header));
}

}  // namespace

void exportBag(const std::string& split_directory, const std::string& layout, const std::string& file,
               double interval) {
  if (layout != "challenge" && layout != "openni")
    throw std::invalid_argument("bag layout is '" + layout + "': must be challenge or openni");
  const bool cloud = layout == "challenge";
  const FrameTopics topics = cloud ? challengeTopics() : openniTopics();
  double seconds = 1.0;
  try {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    for (const BopFrame& entry : readBopSplit(split_directory)) {
      writeFrame(bag, topics, cloud, entry, ros::Time(seconds));
      seconds += interval;
    }
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

}  // namespace recognition
