#include "model/durable_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <zlib.h>

namespace recognition {
namespace {

[[noreturn]] void failWith(const std::string& path, int error) {
  throw std::runtime_error(path + ": " + std::strerror(error));
}

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : path_(path), fd_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (fd_ < 0) failWith(path_, errno);
  }
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void writeAll(const std::string& bytes) {
    for (size_t done = 0; done < bytes.size();) {
      const ssize_t n = write(fd_, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno != EINTR) failWith(path_, errno);
      if (n > 0) done += static_cast<size_t>(n);
    }
  }

  void sync() {
    if (fsync(fd_) != 0) failWith(path_, errno);
  }

 private:
  std::string path_;
  int fd_;
};

}  // namespace

void writeDurably(const std::string& path, const std::string& bytes) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
  file.writeAll(bytes);
  file.sync();
}

void syncDirectory(const std::string& path) { Descriptor(path, O_RDONLY | O_DIRECTORY).sync(); }

std::string readWhole(const std::string& path, std::uint64_t largest) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) failWith(path, errno ? errno : EIO);
  const auto size = static_cast<std::uint64_t>(in.tellg());
  if (size > largest)
    throw std::runtime_error(path + ": has " + std::to_string(size) + " bytes, more than is plausible");
  std::string bytes(size, '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) throw std::runtime_error(path + ": cannot be read");
  return bytes;
}

void putDirectoryInPlace(const std::string& from, const std::string& to, const std::string& displaced) {
  if (std::filesystem::exists(to)) {
    if (syscall(SYS_renameat2, AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0) return;
    if (errno != EINVAL && errno != ENOSYS) failWith(to, errno);
    if (std::rename(to.c_str(), displaced.c_str()) != 0) failWith(to, errno);
  }
  if (std::rename(from.c_str(), to.c_str()) != 0) failWith(to, errno);
}

std::string checksum(const std::string& bytes) {
  const uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  char text[9];
  std::snprintf(text, sizeof(text), "%08lx", crc);
  return text;
}

}  // namespace recognition
