#include "bags/bag_file.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <rosbag/chunked_file.h>
#include <rosbag/constants.h>

namespace recognition {
namespace {

const std::string kVersion = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMaxChunk = 1u << 29;  // bytes, unpacked; rosbag begins a new one after 768 kB

using Fields = std::map<std::string, std::string>;

[[noreturn]] void fail(std::uint64_t at, const std::string& what) {
  throw std::runtime_error("at byte " + std::to_string(at) + ": " + what);
}

std::uint32_t number(const char* bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// "name=value" each, with its length before it. False if they do not fill the bytes exactly.
bool parseFields(const char* begin, const char* end, Fields* fields) {
  while (begin != end) {
    if (end - begin < 4) return false;
    const std::uint32_t length = number(begin);
    begin += 4;
    if (length > static_cast<std::uint64_t>(end - begin)) return false;
    const char* const equals = std::find(begin, begin + length, '=');
    if (equals == begin + length) return false;
    (*fields)[std::string(begin, equals)] = std::string(equals + 1, begin + length);
    begin += length;
  }
  return true;
}

bool hasOp(const Fields& fields, unsigned char op) {
  const auto found = fields.find(rosbag::OP_FIELD_NAME);
  return found != fields.end() && found->second == std::string(1, static_cast<char>(op));
}

rosbag::CompressionType compressionOf(const std::string& name) {
  if (name == rosbag::COMPRESSION_BZ2) return rosbag::compression::BZ2;
  if (name == rosbag::COMPRESSION_LZ4) return rosbag::compression::LZ4;
  if (name == rosbag::COMPRESSION_NONE) return rosbag::compression::Uncompressed;
  throw std::invalid_argument("unknown compression '" + name + "'");
}

}  // namespace

/// A header of fields, and data.
struct BagFile::Record {
  std::uint64_t begin, data, end;
  Fields fields;

  const std::string& text(const std::string& field) const {
    const auto found = fields.find(field);
    if (found == fields.end()) fail(begin, "the record has no field " + field);
    return found->second;
  }
  template <typename Number>
  Number value(const std::string& field) const {
    Number number;
    if (text(field).size() != sizeof number) fail(begin, "the record's field " + field + " has a wrong size");
    std::memcpy(&number, text(field).data(), sizeof number);
    return number;
  }
};

BagFile::BagFile(const std::string& file) : name_(file), in_(file, std::ios::binary | std::ios::ate) {
  if (!in_) throw std::runtime_error(file + ": cannot be read");
  try {
    size_ = static_cast<std::uint64_t>(in_.tellg());
    if (size_ < kVersion.size() || bytesAt(0, kVersion.size()) != kVersion) fail(0, "is no bag of format 2.0");
    readIndex();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

std::string BagFile::bytesAt(std::uint64_t at, std::uint64_t size) {
  if (at > size_ || size > size_ - at) fail(at, "the file ends before " + std::to_string(size) + " bytes are read");
  std::string bytes(size, '\0');
  in_.seekg(static_cast<std::streamoff>(at));
  if (!in_.read(bytes.data(), static_cast<std::streamsize>(size))) fail(at, "cannot be read");
  return bytes;
}

BagFile::Record BagFile::recordAt(std::uint64_t at) {
  const std::uint32_t header_size = number(bytesAt(at, 4).data());
  Record record{at, at + 8 + header_size, 0, {}};
  const std::string header = bytesAt(at + 4, std::uint64_t{header_size} + 4);
  if (!parseFields(header.data(), header.data() + header_size, &record.fields))
    fail(at, "the record's header is damaged");
  record.end = record.data + number(header.data() + header_size);
  if (record.end > size_) fail(at, "the record is longer than the file");
  return record;
}

void BagFile::readIndex() {
  const Record header = recordAt(kVersion.size());
  if (!hasOp(header.fields, rosbag::OP_FILE_HEADER)) fail(header.begin, "the file's header is missing");
  if (header.fields.count(rosbag::ENCRYPTOR_FIELD_NAME)) fail(header.begin, "encrypted bags are not read");
  std::uint64_t at = header.value<std::uint64_t>(rosbag::INDEX_POS_FIELD_NAME);
  if (at == 0) fail(header.begin, "there is no index, as recording did not end; rosbag reindex mends that");
  if (at > size_)
    fail(size_, "the bag is cut short: the file ends before its index, which begins at byte " + std::to_string(at) +
                    "; rosbag reindex mends that");

  for (auto left = header.value<std::uint32_t>(rosbag::CONNECTION_COUNT_FIELD_NAME); left > 0; --left) {
    const Record record = recordAt(at);
    if (!hasOp(record.fields, rosbag::OP_CONNECTION)) fail(at, "is no connection");
    readConnection(record);
    at = record.end;
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> chunks;  // position, and the number of its index records
  for (auto left = header.value<std::uint32_t>(rosbag::CHUNK_COUNT_FIELD_NAME); left > 0; --left) {
    const Record record = recordAt(at);
    if (!hasOp(record.fields, rosbag::OP_CHUNK_INFO)) fail(at, "does not tell of a chunk");
    chunks.emplace_back(record.value<std::uint64_t>(rosbag::CHUNK_POS_FIELD_NAME),
                        record.value<std::uint32_t>(rosbag::COUNT_FIELD_NAME));
    at = record.end;
  }
  std::sort(chunks.begin(), chunks.end());
  std::uint64_t free = header.end;  // so that no bytes are indexed twice
  for (const auto& [chunk, indices] : chunks) {
    if (chunk < free) fail(chunk, "the chunk begins inside of another");
    free = readChunkIndex(chunk, indices);
  }
  std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
}

void BagFile::readConnection(const Record& record) {
  const std::string data = bytesAt(record.data, record.end - record.data);
  Fields about;
  if (!parseFields(data.data(), data.data() + data.size(), &about))
    fail(record.data, "the connection's header is damaged");
  connections_[record.value<std::uint32_t>(rosbag::CONNECTION_FIELD_NAME)] = {record.text(rosbag::TOPIC_FIELD_NAME),
                                                                              about["type"], about["md5sum"]};
}

std::uint64_t BagFile::readChunkIndex(std::uint64_t chunk, std::uint32_t indices) {
  const Record record = recordAt(chunk);
  if (!hasOp(record.fields, rosbag::OP_CHUNK)) fail(chunk, "is no chunk");
  std::uint64_t at = record.end;
  for (; indices > 0; --indices) {
    const Record index = recordAt(at);
    if (!hasOp(index.fields, rosbag::OP_INDEX_DATA)) fail(at, "is no index of a chunk");
    readEntries(index, chunk);
    at = index.end;
  }
  return at;
}

void BagFile::readEntries(const Record& record, std::uint64_t chunk) {
  constexpr std::uint64_t kEntrySize = 12;  // seconds, nanoseconds, offset
  const auto connection = record.value<std::uint32_t>(rosbag::CONNECTION_FIELD_NAME);
  if (!connections_.count(connection)) fail(record.begin, "there is no such connection");
  const auto count = record.value<std::uint32_t>(rosbag::COUNT_FIELD_NAME);
  if (count * kEntrySize != record.end - record.data) fail(record.begin, "the index is not as long as it says");
  const std::string data = bytesAt(record.data, record.end - record.data);
  for (const char* entry = data.data(); entry != data.data() + data.size(); entry += kEntrySize)
    entries_.push_back(
        {number(entry) * std::uint64_t{1000000000} + number(entry + 4), connection, chunk, number(entry + 8)});
}

void BagFile::loadChunk(std::uint64_t chunk) {
  const Record record = recordAt(chunk);
  std::string packed = bytesAt(record.data, record.end - record.data);
  const auto compression = compressionOf(record.text(rosbag::COMPRESSION_FIELD_NAME));
  const auto size = record.value<std::uint32_t>(rosbag::SIZE_FIELD_NAME);
  if (size > kMaxChunk) fail(chunk, std::to_string(size) + " bytes are too many for a chunk");
  if (compression == rosbag::compression::Uncompressed && size != packed.size())
    fail(chunk, "the chunk has another size than it says");
  loaded_ = 0;
  contents_.assign(size, 0);
  rosbag::ChunkedFile().decompress(compression, contents_.data(), size, reinterpret_cast<std::uint8_t*>(packed.data()),
                                   static_cast<unsigned>(packed.size()));
  loaded_ = chunk;
}

BagFile::Span BagFile::messageBytes(const Entry& entry) try {
  if (loaded_ != entry.chunk) loadChunk(entry.chunk);
  const auto check = [&](bool is_good) {
    if (!is_good) fail(entry.chunk, "no whole message at byte " + std::to_string(entry.offset) + " of the chunk");
  };
  const std::uint64_t size = contents_.size(), header = entry.offset + std::uint64_t{4};
  const char* const bytes = reinterpret_cast<const char*>(contents_.data());
  check(header <= size);
  const std::uint64_t header_end = header + number(bytes + entry.offset), data = header_end + 4;
  check(data <= size);
  Fields fields;
  check(parseFields(bytes + header, bytes + header_end, &fields) && hasOp(fields, rosbag::OP_MSG_DATA));
  const std::uint32_t length = number(bytes + header_end);
  check(length <= size - data);
  return {contents_.data() + data, length};
} catch (const std::exception& error) {
  throw std::runtime_error(name_ + ": " + error.what());
}

}  // namespace recognition
