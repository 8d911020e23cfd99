#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

namespace recognition {

/// What image_transport's plug-ins `compressed` and `compressedDepth` (PNG and RVL) wrote, as they would read it. Throw
/// std::invalid_argument for data that is no such image, or a format that is not known.
sensor_msgs::ImagePtr colorFromCompressed(const sensor_msgs::CompressedImage& message);
sensor_msgs::ImagePtr depthFromCompressed(const sensor_msgs::CompressedImage& message);

}  // namespace recognition
