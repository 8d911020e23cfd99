#include "core/shard.h"

#include <cstdio>
#include <stdexcept>

namespace recognition {

Shard Shard::parse(const std::string& text) {
  Shard shard;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.count, &rest);
  if (read != 2 || shard.count < 1 || shard.index < 1 || shard.index > shard.count)
    throw std::invalid_argument("shard is '" + text + "': must be K/N with 1 <= K <= N, as 2/8");
  return shard;
}

}  // namespace recognition
