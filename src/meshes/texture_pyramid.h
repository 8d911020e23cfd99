#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// Mip levels of a mesh's texture. Texels that no triangle covers take no part in the averages and are filled from
/// their covered neighbours, so that coarse levels do not bleed the background of a texture atlas into the charts'
/// borders.
class TexturePyramid {
 public:
  /// The mesh must have a texture (CV_8UC3) and texture coordinates.
  explicit TexturePyramid(const TexturedMesh& mesh);

  /// Colour (BGR, 0..255) around a texture coordinate ((0, 0) lower left; repeats outside 0..1), averaged over about
  /// `footprint` x `footprint` texels of the finest level; linear between texels and levels.
  Eigen::Vector3f sample(const Eigen::Vector2f& coordinate, float footprint) const;

  cv::Size size() const { return levels_.front().size(); }

 private:
  Eigen::Vector3f sampleLevel(int level, const Eigen::Vector2f& coordinate) const;

  std::vector<cv::Mat> levels_;  // CV_8UC3, each half the size of the one before
};

}  // namespace recognition
