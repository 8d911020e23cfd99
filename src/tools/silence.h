#pragma once

namespace recognition {

/// Keeps OpenCV's own log off the screen: what concerns the user is said by us.
void silenceLibraries();

}  // namespace recognition
