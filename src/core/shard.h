#pragma once

#include <cstddef>
#include <string>

namespace recognition {

/// One of several processes that share a piece of work: it takes every `count`-th item, so that any scheduler can start
/// them apart.
struct Shard {
  int index = 1;  ///< 1 .. count
  int count = 1;

  /// From "K/N". Throws std::invalid_argument for anything else than 1 <= K <= N.
  static Shard parse(const std::string& text);

  bool whole() const { return count == 1; }
  bool takes(std::size_t item) const { return static_cast<int>(item % static_cast<std::size_t>(count)) == index - 1; }
  std::string text() const { return std::to_string(index) + "/" + std::to_string(count); }
};

}  // namespace recognition
