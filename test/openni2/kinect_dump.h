#pragma once

#include <string>

namespace recognition::openni2 {

/// Writes a recording (BOP scene or split), over and over for this time, as a dump of a Microsoft Kinect, which
/// libfreenect's fakenect replays once: INDEX.txt, colour as PPM, the infrared camera's 11 bit depth as PGM, 30 Hz;
/// repeated pictures are links. Throws std::runtime_error with the file.
void writeKinectDump(const std::string& recording, const std::string& directory, double seconds);

}  // namespace recognition::openni2
