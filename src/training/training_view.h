#pragma once

#include <vector>

#include "meshes/mesh_renderer.h"
#include "rgbd_recognition/model/object_model.h"
#include "rgbd_recognition/training/training_parameters.h"

namespace recognition {

/// A camera around the object whose image is cut to the object's outline.
struct TrainingCamera {
  CameraModel camera;
  Pose camera_from_object = Pose::Identity();
};

/// `parameters.views` directions at each of `parameters.distances`.
std::vector<TrainingCamera> placeTrainingCameras(const TexturedMesh& mesh, const TrainingParameters& parameters);

/// What the training camera sees, as the extractors want it.
struct TrainingView {
  TrainingCamera from;
  cv::Mat gray;  ///< CV_8UC1, blurred; the object's mean grey around it, so that the outline draws few features
  cv::Mat mask;  ///< CV_8UC1, 255 on the object
  cv::Mat outline_distance;  ///< CV_32FC1, pixels to the nearest outline or jump in depth
};

TrainingView renderTrainingView(const MeshRenderer& renderer, const TrainingCamera& from,
                                const TrainingParameters& parameters);

/// The view's features on the object's surface, in the object frame; those at the outline or on steep surface are left
/// out.
ModelFeatures placeOnSurface(const ImageFeatures& features, const TrainingView& view, const MeshRenderer& renderer,
                             const TrainingParameters& parameters);

}  // namespace recognition
