#pragma once

#include <cstdint>
#include <string>

namespace recognition {

// All throw std::runtime_error with path and the system's reason.

/// Writes a whole file and waits until the disk has it.
void writeDurably(const std::string& path, const std::string& bytes);
/// Waits until the disk has a directory's entries.
void syncDirectory(const std::string& path);
/// Reads a whole file of at most `largest` bytes.
std::string readWhole(const std::string& path, std::uint64_t largest);

/// Puts the directory `from` in the place of `to`, which may exist: readers see the old or the new one. What was there
/// before is at `from` afterwards, if the file system can exchange; else at `displaced`.
void putDirectoryInPlace(const std::string& from, const std::string& to, const std::string& displaced);

/// CRC-32 as zlib, gzip and `crc32` have it, eight hexadecimal digits.
std::string checksum(const std::string& bytes);

}  // namespace recognition
