#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rgbd_recognition/training/recorded_object.h"
#include "rgbd_recognition/core/frame.h"

/// Pictures for whoever trains an object: what the camera sees, and what is missing yet.
namespace recognition {

/// CV_8UC1 of depth's size: 255 on what stands above the plane z = 0 nearest to the world's origin. All 0 if the view
/// has no pose, or nothing stands there.
cv::Mat cutOutObject(const RecordedView& view, const RecordingParameters& parameters);

/// BGR of colour's size: the frame with all but the object darkened, the board's axes (where its pose is known), and
/// `text` below.
cv::Mat drawTrainingView(const RgbdFrame& frame, const std::optional<Pose>& camera_from_board, const cv::Mat& object,
                         const std::string& text);

/// BGR: the upper half of all directions seen from above (the rim is the horizon, the middle straight above, x to the
/// right), green where a view is within 20 degrees; dots are views, a ring is where the camera is now.
cv::Mat drawCoverage(const std::vector<Eigen::Vector3f>& view_directions, const std::optional<Eigen::Vector3f>& now);

}  // namespace recognition
