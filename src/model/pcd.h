#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace recognition {

/// A field of a PCD file: `count` values of kind 'F' (float), 'U' or 'I' (unsigned, signed integer) of `bytes` bytes
/// each.
struct PcdField {
  std::string name;
  char kind = 'F';
  int bytes = 4;
  int count = 1;
};

/// Binary PCD of `points` packed records, each holding the fields in order.
std::string encodePcd(const std::vector<PcdField>& fields, const std::string& records, int points);

/// The packed records of a binary PCD file's bytes, which must have exactly these fields. Throws std::runtime_error
/// with what does not fit.
std::string decodePcd(const std::string& bytes, const std::vector<PcdField>& fields);

/// Bytes of a record.
size_t recordBytes(const std::vector<PcdField>& fields);

}  // namespace recognition
