#pragma once

namespace recognition {

/// Keeps the own words of OpenCV and its image libraries off the screen: what concerns the user is said by us.
void silenceLibraries();

}  // namespace recognition
