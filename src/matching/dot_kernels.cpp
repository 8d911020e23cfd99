#include "matching/dot_kernels.h"

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define RGBD_X86 1
#endif

namespace recognition {

void scorePortable(const DotTask& task) {
  for (int b = 0; b < task.block_count; ++b) {
    std::int32_t sums[kBlockRows] = {};
    for (int lane = 0; lane < task.lanes_per_block; ++lane) {
      const std::uint8_t* rows = task.lanes[b * task.lanes_per_block + lane].values;
      const std::int8_t* query = task.query + 4 * lane;
      for (int r = 0; r < kBlockRows; ++r)
        for (int c = 0; c < 4; ++c) sums[r] += rows[4 * r + c] * query[c];
    }
    unsigned above = 0;
    for (int r = 0; r < kBlockRows; ++r) {
      const std::int32_t score = sums[r] - task.offset - task.half_norms[kBlockRows * b + r];
      task.scores[kBlockRows * b + r] = score;
      above |= (score > task.floor ? 1u : 0u) << r;
    }
    task.above[b] = static_cast<std::uint16_t>(above);
  }
}

#ifdef RGBD_X86
namespace {

std::int32_t fourElements(const std::int8_t* query) {
  std::int32_t packed;
  std::memcpy(&packed, query, sizeof(packed));
  return packed;
}

/// kBlocks blocks at once, so that enough sums are under way to hide the instruction's latency.
template <int kBlocks>
__attribute__((target("avx512f,avx512bw,avx512vnni"))) void vnniBlocks(const DotTask& task, int first) {
  const DescriptorLane* lanes = task.lanes + static_cast<size_t>(first) * task.lanes_per_block;
  __m512i sums[kBlocks];
  for (int b = 0; b < kBlocks; ++b) sums[b] = _mm512_set1_epi32(-task.offset);
  for (int lane = 0; lane < task.lanes_per_block; ++lane) {
    const __m512i query = _mm512_set1_epi32(fourElements(task.query + 4 * lane));
    for (int b = 0; b < kBlocks; ++b)
      sums[b] = _mm512_dpbusd_epi32(sums[b], _mm512_load_si512(lanes + b * task.lanes_per_block + lane), query);
  }
  const __m512i floor = _mm512_set1_epi32(task.floor);
  for (int b = 0; b < kBlocks; ++b) {
    const int row = kBlockRows * (first + b);
    const __m512i scores = _mm512_sub_epi32(sums[b], _mm512_loadu_si512(task.half_norms + row));
    _mm512_storeu_si512(task.scores + row, scores);
    task.above[first + b] = _mm512_cmpgt_epi32_mask(scores, floor);
  }
}

/// Dot product of signed bytes, 4 to an int: |row| <= 127 and |query| <= 127, so the 16-bit pair sums cannot overflow.
__attribute__((target("avx2"))) __m256i dotAvx2(const std::uint8_t* rows, __m256i query_abs, __m256i query,
                                                __m256i ones) {
  const __m256i unsigned_rows = _mm256_load_si256(reinterpret_cast<const __m256i*>(rows));
  const __m256i signed_rows = _mm256_xor_si256(unsigned_rows, _mm256_set1_epi8(-128));
  return _mm256_madd_epi16(_mm256_maddubs_epi16(query_abs, _mm256_sign_epi8(signed_rows, query)), ones);
}

__attribute__((target("avx2"))) int bitsAbove(__m256i scores, __m256i floor) {
  return _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(scores, floor)));
}

/// kBlocks blocks at once, which share the query's registers.
template <int kBlocks>
__attribute__((target("avx2"))) void avx2Blocks(const DotTask& task, int first) {
  const __m256i ones = _mm256_set1_epi16(1), floor = _mm256_set1_epi32(task.floor);
  const DescriptorLane* lanes = task.lanes + static_cast<size_t>(first) * task.lanes_per_block;
  __m256i low[kBlocks], high[kBlocks];
  for (int b = 0; b < kBlocks; ++b) low[b] = high[b] = _mm256_setzero_si256();
  for (int lane = 0; lane < task.lanes_per_block; ++lane) {
    const __m256i query = _mm256_set1_epi32(fourElements(task.query + 4 * lane));
    const __m256i query_abs = _mm256_abs_epi8(query);
    for (int b = 0; b < kBlocks; ++b) {
      const std::uint8_t* rows = lanes[b * task.lanes_per_block + lane].values;
      low[b] = _mm256_add_epi32(low[b], dotAvx2(rows, query_abs, query, ones));
      high[b] = _mm256_add_epi32(high[b], dotAvx2(rows + 32, query_abs, query, ones));
    }
  }
  for (int b = 0; b < kBlocks; ++b) {
    const auto* half_norms = reinterpret_cast<const __m256i*>(task.half_norms + kBlockRows * (first + b));
    auto* scores = reinterpret_cast<__m256i*>(task.scores + kBlockRows * (first + b));
    low[b] = _mm256_sub_epi32(low[b], _mm256_loadu_si256(half_norms));
    high[b] = _mm256_sub_epi32(high[b], _mm256_loadu_si256(half_norms + 1));
    _mm256_storeu_si256(scores, low[b]);
    _mm256_storeu_si256(scores + 1, high[b]);
    task.above[first + b] = static_cast<std::uint16_t>(bitsAbove(low[b], floor) | bitsAbove(high[b], floor) << 8);
  }
}

}  // namespace

__attribute__((target("avx512f,avx512bw,avx512vnni"))) void scoreAvx512Vnni(const DotTask& task) {
  int first = 0;
  for (; first + 8 <= task.block_count; first += 8) vnniBlocks<8>(task, first);
  switch (task.block_count - first) {
    case 1:
      return vnniBlocks<1>(task, first);
    case 2:
      return vnniBlocks<2>(task, first);
    case 3:
      return vnniBlocks<3>(task, first);
    case 4:
      return vnniBlocks<4>(task, first);
    case 5:
      return vnniBlocks<5>(task, first);
    case 6:
      return vnniBlocks<6>(task, first);
    case 7:
      return vnniBlocks<7>(task, first);
    default:
      return;
  }
}

__attribute__((target("avx2"))) void scoreAvx2(const DotTask& task) {
  int first = 0;
  for (; first + 3 <= task.block_count; first += 3) avx2Blocks<3>(task, first);
  if (task.block_count - first == 2) return avx2Blocks<2>(task, first);
  if (task.block_count - first == 1) avx2Blocks<1>(task, first);
}
#else
void scoreAvx2(const DotTask& task) { scorePortable(task); }
void scoreAvx512Vnni(const DotTask& task) { scorePortable(task); }
#endif

}  // namespace recognition
