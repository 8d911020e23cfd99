#include "ros/training_outputs.h"

#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>

#include "ros/detection_output.h"
#include "ros/image_conversions.h"
#include "ros/message_conversions.h"
#include "training/training_pictures.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {
namespace {

const ros::WallDuration kCloudInterval(1.0);
constexpr std::uint64_t kWaiting = 1000000000;  // nanoseconds without a board
constexpr int kLiveStep = 2;                    // depth pixels between the points of the live cloud

void publishCloud(const ros::Publisher& publisher, const std::vector<SurfacePoint>& cloud,
                  const std_msgs::Header& header) {
  publisher.publish(boost::make_shared<sensor_msgs::PointCloud2>(cloudMessage(cloud, header)));
}

std::vector<SurfacePoint> livePoints(const RecordedView& recorded, const cv::Mat& object) {
  const RgbdFrame& frame = recorded.frame;
  const CameraModel camera = frame.depthCamera();
  const cv::Mat depth = depthInMetres(frame.depth);
  const Pose world_from_camera = recorded.camera_from_world->inverse();
  const int k = frame.colorPerDepthPixel();
  std::vector<SurfacePoint> points;
  for (int v = 0; v < depth.rows; v += kLiveStep)
    for (int u = 0; u < depth.cols; u += kLiveStep) {
      const float z = depth.at<float>(v, u);
      if (object.at<uchar>(v, u) == 0 || !(z > 0.0f)) continue;
      const auto& pixel = frame.color.at<cv::Vec3b>(k * v, k * u);
      const bool rgb = frame.color_order == ColorOrder::kRgb;
      points.push_back({(world_from_camera * camera.unproject(u, v, z)).cast<float>(), Eigen::Vector3f::UnitZ(),
                        rgb ? pixel : cv::Vec3b(pixel[2], pixel[1], pixel[0])});
    }
  return points;
}

tf2_msgs::TFMessagePtr boardTransform(const Pose& camera_from_board, const std_msgs::Header& header,
                                      const std::string& board_frame) {
  const auto message = boost::make_shared<tf2_msgs::TFMessage>();
  message->transforms = {transformMessage(poseMessage(camera_from_board), header, board_frame)};
  return message;
}

std_msgs::Header withFrame(std_msgs::Header header, const std::string& frame) {
  header.frame_id = frame;
  return header;
}

}  // namespace

void TrainingOutputs::showView(const RecordedView& recorded, const RecordingParameters& parameters,
                               const std_msgs::Header& header, const std::string& text) const {
  if (recorded.camera_from_world) {
    board_shown_ = ros::WallTime::now().toNSec();
    tf.publish(boardTransform(*recorded.camera_from_world, header, board_frame));
  }
  if (!viewWanted()) return;
  const cv::Mat object = cutOutObject(recorded, parameters);
  if (view.getNumSubscribers() > 0)
    view.publish(imageMessage(drawTrainingView(recorded.frame, recorded.camera_from_world, object, text), header));
  if (recorded.camera_from_world && live_cloud.getNumSubscribers() > 0)
    publishCloud(live_cloud, livePoints(recorded, object), withFrame(header, board_frame));
}

void TrainingOutputs::showWaiting() const {
  if (ros::WallTime::now().toNSec() - board_shown_ < kWaiting) return;
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  header.frame_id = board_frame + "_waiting";
  tf.publish(boardTransform(Pose::Identity(), header, board_frame));
}

void TrainingOutputs::showObject(const RecordedObject& recorded, const std_msgs::Header& header) {
  if (coverage.getNumSubscribers() > 0) {
    std::optional<Eigen::Vector3f> now;
    if (recorded.lastPose()) now = recorded.lastPose()->inverse().translation().cast<float>().normalized();
    coverage.publish(imageMessage(drawCoverage(recorded.viewDirections(), now), header));
  }
  const ros::WallTime time = ros::WallTime::now();
  if (cloud.getNumSubscribers() == 0 || time - cloud_shown_ < kCloudInterval) return;
  cloud_shown_ = time;
  publishCloud(cloud, recorded.roughCloud(), withFrame(header, board_frame));
}

void TrainingOutputs::showProgress(const messages::TrainingProgress& message) const { progress.publish(message); }

void TrainingOutputs::clear(const std_msgs::Header& header) {
  cloud_shown_ = {};
  publishCloud(cloud, {}, withFrame(header, board_frame));
  if (coverage.getNumSubscribers() > 0) coverage.publish(imageMessage(drawCoverage({}, std::nullopt), header));
}

void TrainingOutputs::showModel(const ObjectModel& model, const std_msgs::Header& header) const {
  const std_msgs::Header in_board = withFrame(header, board_frame);
  publishCloud(object, model.cloud, in_board);
  ModelDatabase one;
  one.objects.push_back(std::make_shared<ObjectModel>(model));
  messages::DetectionArray at_origin;
  at_origin.header = in_board;
  at_origin.detections.resize(1);
  at_origin.detections.front().object = model.name;
  at_origin.detections.front().pose.pose.orientation.w = 1.0;
  object_markers.publish(MarkerMaker().make(at_origin, one, LabelView()));
}

}  // namespace recognition
