#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "rgbd_recognition/core/camera.h"
#include "rgbd_recognition/core/distortion.h"

namespace recognition {

/// A camera as a file describes it.
struct CameraFile {
  CameraModel camera;  ///< of the image as it is; width and height are 0 where the file does not say
  Distortion distortion;
  std::optional<CameraModel> rectified;  ///< of the image without distortion, where the file says (P)
  double depth_scale = 1.0;              ///< depth file's unit in millimetres
};

/// Reads, by content rather than by name: JSON with cam_K, K, camera_matrix or intrinsic_matrix (flat or nested), or
/// fx, fy, cx, cy (ppx, ppy); BOP's scene_camera.json, of which the entry of `frame` is taken; nine numbers
/// (cam_K.txt); ROS's camera_info as yaml or ini; OpenCV's yaml. Throws std::runtime_error with file and reason.
CameraFile readCameraFile(const std::string& file, std::optional<int> frame);

/// A camera from an entry of JSON; throws std::runtime_error with the reason.
CameraFile cameraFromJson(const nlohmann::json& entry);

/// Of ROS's camera_info; both throw std::runtime_error with the reason.
CameraFile cameraFromYaml(const std::string& text);
CameraFile cameraFromIni(const std::string& text);

/// Under which names files have the camera matrix, and the coefficients of distortion.
const std::vector<std::string>& matrixKeys();
const std::vector<std::string>& distortionKeys();

/// ROS's name of a model of distortion that has another name elsewhere (as "distortion.brown_conrady").
std::string distortionModel(const std::string& name);

/// From nine numbers, row by row or (Open3D) column by column. Throws std::runtime_error for what is no camera matrix.
void setMatrix(const std::vector<double>& k, CameraModel* camera);

}  // namespace recognition
