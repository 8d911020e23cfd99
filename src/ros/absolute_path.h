#pragma once

#include <string>

namespace recognition {

/// The path as a message should name it: `~` is the home folder, and what is relative is below `folder`, or where that
/// is empty below the process's working folder, which for a nodelet is none that its user knows. Empty stays empty.
std::string absolutePath(const std::string& path, const std::string& folder = "");

}  // namespace recognition
