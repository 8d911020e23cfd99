#pragma once

#include <memory>
#include <vector>

#include "rgbd_recognition/core/frame.h"
#include "features/feature_extractor.h"
#include "rgbd_recognition/meshes/mesh.h"
#include "meshes/mesh_renderer.h"
#include "rgbd_recognition/model/object_model.h"

namespace recognition::benchmarks {

/// A box or cylinder with an invented print, and its model. Trained in a fraction of a second: features come from the
/// texture itself, at two resolutions, and are placed on the surface through the texture coordinates.
struct PrintedObject {
  std::shared_ptr<const TexturedMesh> mesh;
  std::shared_ptr<const ObjectModel> model;
};

/// The same object for the same number.
PrintedObject makePrintedObject(int number, const FeatureExtractor& extractor, DescriptorType type);

/// Places of image features on a mesh whose texture the image is (at any resolution); features that lie on no triangle
/// are left out.
ModelFeatures placeOnSurface(const ImageFeatures& features, cv::Size image, const TexturedMesh& mesh);

/// A frame with known answers.
struct PrintedScene {
  RgbdFrame frame;
  cv::Mat regions;                       ///< CV_8UC1, size of the colour image: 255 on the objects
  std::vector<Pose> camera_from_object;  ///< as the meshes given
};

/// The meshes side by side in random attitudes in front of a patterned wall, 1280x960 colour over 640x480 depth with a
/// Kinect's noise.
PrintedScene makePrintedScene(const std::vector<std::shared_ptr<const TexturedMesh>>& meshes, int seed);

}  // namespace recognition::benchmarks
