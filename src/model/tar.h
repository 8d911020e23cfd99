#pragma once

#include <map>
#include <string>

namespace recognition {

/// A POSIX tar archive (ustar) of some files, all in the folder `folder`.
std::string encodeTar(const std::string& folder, const std::map<std::string, std::string>& files);

/// The plain files of an archive by their names without folders. Throws std::runtime_error with what is wrong.
std::map<std::string, std::string> decodeTar(const std::string& archive);

}  // namespace recognition
