#pragma once

#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include "rgbd_recognition/meshes/mesh.h"
#include "bags/bag_writer.h"
#include "ros/message_conversions.h"
#include "training/turntable.h"
#include "rgbd_recognition/core/frame.h"

namespace recognition {

inline const std::string kBoards = std::string(RGBD_SOURCE_DIR) + "/config/boards";

/// The demo's cracker box, which stands in the demo's real frames too, on a ChArUco board.
class CrackerBox {
 public:
  CrackerBox()
      : mesh_(readMesh(RGBD_TEST_DATA "/demo/models/obj_000002.ply", 0.001)),
        turntable_(FiducialBoard::fromYaml(kBoards + "/charuco.yaml"), mesh_, upright()) {}

  RgbdFrame view(const Pose& camera_from_board) const { return turntable_.view(camera_from_board, 1); }

 private:
  Pose upright() const {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh_.vertices) box.extend(vertex);
    return Pose(Eigen::Translation3d(-box.center().x(), -box.center().y(), -box.min().z()));
  }

  TexturedMesh mesh_;
  Turntable turntable_;
};

/// camera_from_board of the recording's views: once around, and once more from above.
inline const std::vector<Pose>& poses() {
  static const std::vector<Pose> poses = [] {
    std::vector<Pose> all;
    for (int i = 0; i < 20; ++i) all.push_back(orbitPose(18.0 * i, 30.0, 0.7, {0, 0, 0.08}));
    for (int i = 0; i < 8; ++i) all.push_back(orbitPose(45.0 * i, 60.0, 0.7, {0, 0, 0.08}));
    return all;
  }();
  return poses;
}

inline const std::vector<RgbdFrame>& recording() {
  static const std::vector<RgbdFrame> frames = [] {
    const CrackerBox box;
    std::vector<RgbdFrame> all;
    for (const Pose& pose : poses()) all.push_back(box.view(pose));
    return all;
  }();
  return frames;
}

inline std::string writeBag(const std::string& file, const std::vector<RgbdFrame>& frames) {
  BagWriter writer(file, openniTopics());
  std::int64_t stamp = 1000000000;
  for (const RgbdFrame& frame : frames) writer.write(frame, stamp += 100000000);
  writer.close();
  return file;
}

/// Where the board is, as frame "stand".
inline tf2_msgs::TFMessage transformOf(const Pose& camera_from_board, const std_msgs::Header& header) {
  tf2_msgs::TFMessage message;
  message.transforms = {transformMessage(poseMessage(camera_from_board), header, "stand")};
  return message;
}

/// The recording with the poses as tf.
inline std::string writeBagWithTf(const std::string& file) {
  writeBag(file, recording());
  rosbag::Bag bag(file, rosbag::bagmode::Append);
  std_msgs::Header header;
  header.frame_id = "camera_rgb_optical_frame";
  for (size_t i = 0; i < poses().size(); ++i) {
    header.stamp = ros::Time(1.1 + 0.1 * static_cast<double>(i));
    bag.write("/tf", header.stamp, transformOf(poses()[i], header));
  }
  return file;
}

}  // namespace recognition
