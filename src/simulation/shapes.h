#pragma once

#include "rgbd_recognition/meshes/mesh.h"

namespace recognition {

/// Textured primitives about the origin, sizes in metres. Each throws std::invalid_argument for a size that is not
/// positive.

/// Faces share one texture atlas of 3 x 2 cells: +x -x +y / -y +z -z.
TexturedMesh makeBox(const Eigen::Vector3d& size, const cv::Mat& texture);

/// Axis along z; the mantle takes the upper three quarters of the texture, the lids the corners of the lowest quarter.
TexturedMesh makeCylinder(double radius, double height, const cv::Mat& texture, int sides = 48);

TexturedMesh makeSphere(double radius, const cv::Mat& texture, int rings = 24);

/// A rectangle in the plane z = 0 that faces +z; the texture repeats every `tile` metres.
TexturedMesh makeTiledPlane(double width, double length, double tile, const cv::Mat& texture);

/// A rectangle in the plane z = 0 that faces +z, with the texture once: its left edge at -x, its upper edge at +y.
TexturedMesh makePrintedPlane(double width, double length, const cv::Mat& texture);

}  // namespace recognition
