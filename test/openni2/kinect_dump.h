#pragma once

#include <string>

namespace rgbd_recognition::openni2 {

/// Writes a recording (BOP scene or split) as a dump of a Microsoft Kinect, which libfreenect's fakenect replays:
/// INDEX.txt, colour as PPM, the infrared camera's 11 bit depth as PGM, 30 Hz. Throws std::runtime_error with the file.
void writeKinectDump(const std::string& recording, const std::string& directory);

}  // namespace rgbd_recognition::openni2
