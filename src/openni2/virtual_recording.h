#pragma once

#include <opencv2/core.hpp>

#include <map>
#include <string>
#include <vector>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/evaluation/bop_dataset.h"

namespace recognition::openni2 {

/// A recording in BOP's form (one scene's folder, or a split: a folder of scenes), frames read when they are asked for.
class VirtualRecording {
 public:
  /// Throws std::runtime_error that names the folder when it is no recording.
  explicit VirtualRecording(const std::string& directory);

  struct Images {
    cv::Mat rgb;       ///< CV_8UC3
    cv::Mat depth_mm;  ///< CV_16UC1 registered to rgb, 0 unknown
    CameraModel color_camera;
  };

  int size() const { return static_cast<int>(frames_.size()); }
  const CameraModel& colorCamera() const { return color_camera_; }
  Images load(int frame) const;

 private:
  std::vector<BopFrame> frames_;
  CameraModel color_camera_;  ///< of the first frame
};

/// What a Kinect's streams give of the recorded images: brought to the mode's size by its width; rows below are cut
/// off or black, as the Kinect's 1280x1024 colour has more rows than its 640x480 depth covers.
cv::Mat colorImage(const VirtualRecording::Images& images, int width, int height);
/// Grey levels, 10 bits in CV_16UC1.
cv::Mat infraredImage(const VirtualRecording::Images& images, int width, int height);
/// Registered: as recorded. Otherwise as the infrared camera beside the colour camera sees it.
cv::Mat depthImage(const VirtualRecording::Images& images, int width, int height, bool registered);

}  // namespace recognition::openni2
