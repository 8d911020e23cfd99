#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include "model/temporary_directory.h"

namespace recognition {

/// A folder for the inputs of one fuzzer, in memory where the system has such.
inline const TemporaryDirectory& fuzzFolder() {
  if (std::filesystem::is_directory("/dev/shm")) setenv("TMPDIR", "/dev/shm", 0);
  static const TemporaryDirectory folder;
  return folder;
}

/// The input as a file of that name.
inline std::string inputFile(const std::string& name, const std::uint8_t* data, size_t size) {
  const std::string file = fuzzFolder() / name;
  writeText(file, std::string(data, data + size));
  return file;
}

/// Adds a first input to the corpus, where the environment names one.
inline void writeSeed(const std::string& name, const std::string& bytes) {
  if (const char* folder = std::getenv("RGBD_FUZZ_SEEDS")) writeText(std::string(folder) + "/" + name, bytes);
}

/// Bad input may throw what says so; all else that happens is a finding.
template <typename Function>
void mayRefuse(const Function& function) {
  try {
    function();
  } catch (const std::exception&) {
  }
}

}  // namespace recognition
