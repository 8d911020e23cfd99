#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

namespace recognition {

/// A generator of its own for each item (frame, image row, body, ...), so that results do not depend on the order of
/// work or on threads. Equal arguments give equal streams.
inline cv::RNG randomStream(std::uint64_t seed, std::uint64_t item, std::uint64_t part = 0) {
  const auto mix = [](std::uint64_t x) {  // SplitMix64
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  };
  return cv::RNG(mix(mix(mix(seed) ^ item) ^ part));
}

/// One item of a non-empty container.
template <typename Container>
const auto& pick(const Container& items, cv::RNG& rng) {
  return items[static_cast<std::size_t>(rng.uniform(0, static_cast<int>(items.size())))];
}

/// exp of a uniform draw between the logarithms: even over orders of magnitude.
inline double logUniform(cv::RNG& rng, double min, double max) {
  return std::exp(rng.uniform(std::log(min), std::log(max)));
}

}  // namespace recognition
