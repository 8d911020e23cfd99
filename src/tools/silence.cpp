#include "tools/silence.h"

#include <unistd.h>

#include <cstdio>
#include <string>

#include <opencv2/core/utils/logger.hpp>

namespace recognition {
namespace {

/// How the image libraries begin what they print of damaged files; our own messages name the file and the reason.
const char* const kOthersWords[] = {"libpng ", "Corrupt JPEG", "Premature end of JPEG", "Invalid JPEG", "TIFF"};

bool isOthers(const std::string& text) {
  for (const char* const words : kOthersWords)
    if (text.rfind(words, 0) == 0) return true;
  return false;
}

/// Lets through to standard error what begins with none of those words.
ssize_t writeOurs(void*, const char* bytes, size_t size) {
  static bool drops_line = false;  // guarded by the stream's lock
  const std::string text(bytes, size);
  if (drops_line || isOthers(text)) {
    drops_line = text.find('\n') == std::string::npos;
    return static_cast<ssize_t>(size);
  }
  return ::write(STDERR_FILENO, bytes, size);
}

}  // namespace

void silenceLibraries() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cookie_io_functions_t functions{};
  functions.write = writeOurs;
  if (std::FILE* const filtered = fopencookie(nullptr, "w", functions)) {
    std::setvbuf(filtered, nullptr, _IONBF, 0);
    stderr = filtered;
  }
}

}  // namespace recognition
