#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/pose.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// One object to draw.
struct Annotation {
  int object = -1;  ///< index in the database: picks cloud and colour
  Pose camera_from_object = Pose::Identity();
  std::string label;      ///< e.g. nameWithConfidence()
  bool rejected = false;  ///< drawn thin, in red, without axes
};

/// "cracker_box 0.97".
std::string nameWithConfidence(const std::string& name, double confidence);

/// A colour (BGR) for the object with this index: the same in images, markers and reports.
cv::Scalar objectColor(int object);

/// Scale of cv::FONT_HERSHEY_SIMPLEX at which a text in a picture of this size can be read.
double readableTextScale(const cv::Size& picture);
/// Of what was rejected, in pictures (BGR).
cv::Scalar rejectedColor();

/// Draws each object's outline, axes (x red, y green, z blue; 5 cm) and label into `bgr` (CV_8UC3), seen by `camera`.
void drawAnnotations(cv::Mat& bgr, const std::vector<Annotation>& annotations, const ModelDatabase& database,
                     const CameraModel& camera);

}  // namespace recognition
