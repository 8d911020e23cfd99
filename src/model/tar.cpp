#include "model/tar.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <stdexcept>

namespace recognition {
namespace {

constexpr size_t kBlock = 512;

// IEEE Std 1003.1, pax: the ustar header block.
struct Header {
  char name[100], mode[8], uid[8], gid[8], size[12], mtime[12], checksum[8], type, link[100], magic[6], version[2];
  char user[32], group[32], major[8], minor[8], prefix[155], padding[12];
};
static_assert(sizeof(Header) == kBlock);

template <size_t N>
void putOctal(char (&field)[N], size_t value) {
  std::snprintf(field, N, "%0*zo", static_cast<int>(N - 1), value);
}

size_t sumOf(Header header) {
  std::memset(header.checksum, ' ', sizeof(header.checksum));
  const auto* bytes = reinterpret_cast<const unsigned char*>(&header);
  return std::accumulate(bytes, bytes + kBlock, size_t(0));
}

Header makeHeader(const std::string& name, size_t size) {
  Header header;
  std::memset(&header, 0, sizeof(header));
  if (name.size() >= sizeof(header.name) + sizeof(header.prefix))
    throw std::runtime_error(name + ": too long a name for an archive");
  const size_t slash = name.find('/');  // the folder may be long: it goes into the prefix
  std::snprintf(header.prefix, sizeof(header.prefix), "%s", name.substr(0, slash).c_str());
  std::snprintf(header.name, sizeof(header.name), "%s", name.substr(slash + 1).c_str());
  putOctal(header.mode, 0644);
  putOctal(header.uid, 0);
  putOctal(header.gid, 0);
  putOctal(header.size, size);
  putOctal(header.mtime, 0);
  header.type = '0';
  std::memcpy(header.magic, "ustar", 6);
  std::memcpy(header.version, "00", 2);
  putOctal(header.checksum, sumOf(header));
  return header;
}

size_t roundedUp(size_t size) { return (size + kBlock - 1) / kBlock * kBlock; }

}  // namespace

std::string encodeTar(const std::string& folder, const std::map<std::string, std::string>& files) {
  std::string archive;
  for (const auto& [name, bytes] : files) {
    const Header header = makeHeader(folder + "/" + name, bytes.size());
    archive.append(reinterpret_cast<const char*>(&header), kBlock);
    archive += bytes;
    archive.append(roundedUp(bytes.size()) - bytes.size(), '\0');
  }
  return archive.append(2 * kBlock, '\0');
}

std::map<std::string, std::string> decodeTar(const std::string& archive) {
  std::map<std::string, std::string> files;
  for (size_t at = 0; at + kBlock <= archive.size();) {
    Header header;
    std::memcpy(&header, archive.data() + at, kBlock);
    if (header.name[0] == '\0' && header.size[0] == '\0') return files;
    if (std::memcmp(header.magic, "ustar", 5) != 0 ||
        std::strtoul(std::string(header.checksum, 8).c_str(), nullptr, 8) != sumOf(header))
      throw std::runtime_error("is no tar archive, or damaged");
    const size_t size = std::strtoull(std::string(header.size, sizeof(header.size)).c_str(), nullptr, 8);
    at += kBlock;
    if (size > archive.size() - at) throw std::runtime_error("is cut short");
    const std::string name(header.name, strnlen(header.name, sizeof(header.name)));
    if (header.type == '0' || header.type == '\0') files[name.substr(name.rfind('/') + 1)] = archive.substr(at, size);
    at += roundedUp(size);
  }
  throw std::runtime_error("is cut short");
}

}  // namespace recognition
