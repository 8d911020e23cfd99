#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <boost/make_shared.hpp>
#include <ros/message_traits.h>
#include <ros/serialization.h>

namespace recognition {

/// A bag of format 2.0, read without trust in its lengths and positions: rosbag's own reader takes memory for, and
/// reads as far as, whatever a damaged file says. Indexed bags only, and none that is encrypted. Errors are
/// std::runtime_error that names the file, the byte and what is wrong there.
class BagFile {
 public:
  struct Connection {
    std::string topic, type, md5sum;
  };
  /// Where a message stands.
  struct Entry {
    std::uint64_t time = 0;  ///< of recording, nanoseconds
    std::uint32_t connection = 0;
    std::uint64_t chunk = 0;   ///< byte of the file at which its chunk begins
    std::uint32_t offset = 0;  ///< in the chunk's contents
  };

  /// Reads the index.
  explicit BagFile(const std::string& file);

  const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
  /// All messages in order of time.
  const std::vector<Entry>& entries() const { return entries_; }
  const Connection& connection(const Entry& entry) const { return connections_.at(entry.connection); }

  /// Null if the message is of another type.
  template <typename Message>
  boost::shared_ptr<const Message> message(const Entry& entry) {
    if (connection(entry).md5sum != ros::message_traits::md5sum<Message>()) return nullptr;
    const Span bytes = messageBytes(entry);
    const auto message = boost::make_shared<Message>();
    try {
      BoundedStream stream(bytes.begin, bytes.size);
      ros::serialization::deserialize(stream, *message);
    } catch (const ros::serialization::StreamOverrunException&) {
      throw std::runtime_error(name_ + ": a message on " + connection(entry).topic + " is shorter than it says");
    }
    return message;
  }

 private:
  struct Record;
  struct Span {
    std::uint8_t* begin;
    std::uint32_t size;
  };

  /// Takes memory for no array that is longer than the bytes left.
  struct BoundedStream : ros::serialization::IStream {
    using IStream::IStream;
    template <typename T>
    void next(T& value) {
      ros::serialization::deserialize(*this, value);
    }
    template <typename T, typename Allocator>
    void next(std::vector<T, Allocator>& array) {
      BoundedStream ahead = *this;
      std::uint32_t length = 0;
      ahead.next(length);
      if (length > ahead.getLength()) ros::serialization::throwStreamOverrun();
      ros::serialization::deserialize(*this, array);
    }
  };

  std::string bytesAt(std::uint64_t at, std::uint64_t size);
  Record recordAt(std::uint64_t at);
  void readIndex();
  void readConnection(const Record& record);
  /// `indices`: how many index records follow the chunk. Returns where they end.
  std::uint64_t readChunkIndex(std::uint64_t chunk, std::uint32_t indices);
  void readEntries(const Record& record, std::uint64_t chunk);
  void loadChunk(std::uint64_t chunk);
  Span messageBytes(const Entry& entry);

  std::string name_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<Entry> entries_;
  std::uint64_t loaded_ = 0;  // the chunk whose contents follow; 0: none
  std::vector<std::uint8_t> contents_;
};

}  // namespace recognition
