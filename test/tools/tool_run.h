#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <sys/wait.h>

#include "model/temporary_directory.h"

namespace recognition {

/// How a command line ended.
struct ToolRun {
  int exit_code = -1;
  std::string said;  ///< on standard output and error
};

inline std::string textOf(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

inline ToolRun runTool(const std::string& program, const std::string& arguments) {
  const TemporaryDirectory directory;
  const int status = std::system((program + " " + arguments + " > " + (directory / "said") + " 2>&1").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, textOf(directory / "said")};
}

}  // namespace recognition
