#pragma once

#include <cstdint>

#include "matching/quantized_descriptors.h"

namespace recognition {

/// One stretch of blocks and one query; `offset` is 128 times the query's sum, which the unsigned rows add to every dot
/// product.
struct DotTask {
  const DescriptorLane* lanes;
  const std::int32_t* half_norms;
  int block_count;
  int lanes_per_block;
  const std::int8_t* query;
  std::int32_t offset;
  std::int32_t floor;
  std::int32_t* scores;
  std::uint16_t* above;  ///< of each block: a bit for each row whose score is above the floor
};

void scorePortable(const DotTask& task);
void scoreAvx2(const DotTask& task);
void scoreAvx512Vnni(const DotTask& task);

}  // namespace recognition
