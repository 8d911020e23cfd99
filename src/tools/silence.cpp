#include "tools/silence.h"

#include <opencv2/core/utils/logger.hpp>

namespace recognition {

void silenceLibraries() { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); }

}  // namespace recognition
