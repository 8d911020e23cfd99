#pragma once

#include <string>
#include <vector>

#include "rgbd_recognition/model/object_model.h"

namespace recognition {

// Cloud and features as binary PCD. Decoding throws std::runtime_error for values that no model has (not finite,
// normals not of unit length, metres-wide).

std::string encodeCloud(const std::vector<SurfacePoint>& cloud);
std::vector<SurfacePoint> decodeCloud(const std::string& pcd);

/// Descriptors as quantizedDescriptors() gives them. Before format 2 each was scaled to its own largest element.
std::string encodeFeatures(const ModelFeatures& features, DescriptorType type);
ModelFeatures decodeFeatures(const std::string& pcd, DescriptorType type, int format_version);

}  // namespace recognition
