#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace rgbd_recognition {

// Cloud and features as binary PCD. Decoding throws std::runtime_error for values that no model has (not finite,
// normals not of unit length, metres-wide).

std::string encodeCloud(const std::vector<SurfacePoint>& cloud);
std::vector<SurfacePoint> decodeCloud(const std::string& pcd);

/// Descriptors as 8-bit integers, each scaled to its largest element; their length is 1 by definition, so no scale is
/// stored.
std::string encodeFeatures(const ModelFeatures& features, DescriptorType type);
ModelFeatures decodeFeatures(const std::string& pcd, DescriptorType type);

}  // namespace rgbd_recognition
