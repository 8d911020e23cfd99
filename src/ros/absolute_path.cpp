#include "ros/absolute_path.h"

#include <cstdlib>
#include <filesystem>

namespace recognition {

std::string absolutePath(const std::string& path, const std::string& folder) {
  if (path.empty()) return path;
  const char* home = std::getenv("HOME");
  std::filesystem::path absolute(path);
  if (home && path == "~") absolute = home;
  if (home && path.rfind("~/", 0) == 0) absolute = std::filesystem::path(home) / path.substr(2);
  if (!folder.empty()) absolute = std::filesystem::path(folder) / absolute;  // which stays what it is if it is absolute
  return std::filesystem::absolute(absolute).lexically_normal().string();
}

}  // namespace recognition
