#pragma once

#include <opencv2/core.hpp>

#include <string>

#include "model/temporary_directory.h"

namespace recognition::openni2 {

constexpr double kTestFocalLength = 525.0;

/// What frame `index` of the test recording shows (its pictures repeat every four frames): colour of column u, row v
/// (RGB), and depth in millimetres.
cv::Vec3b testColor(int index, int u, int v);
int testDepth(int index, int u);

/// Writes a BOP scene, 640x480, f = 525, principal point (310, 245); returns its folder.
std::string writeTestRecording(const std::string& directory, int frames);

/// Plugs a device in at a port of the virtual bus, and out again.
void plugIn(const std::string& bus, const std::string& port, const std::string& source, const std::string& serial = "",
            const std::string& access = "");
void plugOut(const std::string& bus, const std::string& port);

}  // namespace recognition::openni2
