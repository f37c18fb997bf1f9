// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "perception/reconstruction/simd_lanes.hpp"

// Transposes records of eight numbers (array of structures) to lanes (structure of arrays) and
// back, by loads and shuffles: a gather for each member would access every record eight times.
// Internal linkage, as in simd_lanes.hpp.
namespace pcavr {
namespace {

/// One record in each lane: of[i] is member i of every record.
struct RecordLanes {
  Floats of[8];
};

#if defined(__AVX512F__)

/// Transposes the 4x4 matrix in each quarter of four registers.
inline void transpose_quarters(__m512 r[4]) {
  const __m512 a = _mm512_unpacklo_ps(r[0], r[1]);
  const __m512 b = _mm512_unpackhi_ps(r[0], r[1]);
  const __m512 c = _mm512_unpacklo_ps(r[2], r[3]);
  const __m512 d = _mm512_unpackhi_ps(r[2], r[3]);
  r[0] = _mm512_shuffle_ps(a, c, 0x44);
  r[1] = _mm512_shuffle_ps(a, c, 0xEE);
  r[2] = _mm512_shuffle_ps(b, d, 0x44);
  r[3] = _mm512_shuffle_ps(b, d, 0xEE);
}

[[maybe_unused]] inline RecordLanes load_records(const float* base, Ints index) {
  alignas(64) std::int32_t at[kLanes];
  __builtin_memcpy(at, &index, sizeof(at));
  asm("" : "+m"(at));  // through memory: extracting lanes would occupy the shuffle port
  __m512 r[8];
  for (int i = 0; i < 8; ++i) {
    // Records 0 to 3 with 4 to 7, then 8 to 11 with 12 to 15.
    const int first = i < 4 ? i : i + 4;
    r[i] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_load_ps(base + 8L * at[first])),
                              _mm256_load_ps(base + 8L * at[first + 4]), 1);
  }
  transpose_quarters(r);
  transpose_quarters(r + 4);
  RecordLanes result;
  for (int i = 0; i < 4; ++i) {
    result.of[i] = (Floats)_mm512_shuffle_f32x4(r[i], r[i + 4], 0x88);
    result.of[i + 4] = (Floats)_mm512_shuffle_f32x4(r[i], r[i + 4], 0xDD);
  }
  return result;
}

/// Writes the kLanes records contiguously.
[[maybe_unused]] inline void store_records(const RecordLanes& members, float* to) {
  __m512 low[4];
  __m512 high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = (__m512)members.of[i];
    high[i] = (__m512)members.of[i + 4];
  }
  transpose_quarters(low);
  transpose_quarters(high);
  for (int i = 0; i < 4; ++i, to += 8) {
    _mm_store_ps(to, _mm512_castps512_ps128(low[i]));
    _mm_store_ps(to + 4, _mm512_castps512_ps128(high[i]));
    _mm_store_ps(to + 32, _mm512_extractf32x4_ps(low[i], 1));
    _mm_store_ps(to + 36, _mm512_extractf32x4_ps(high[i], 1));
    _mm_store_ps(to + 64, _mm512_extractf32x4_ps(low[i], 2));
    _mm_store_ps(to + 68, _mm512_extractf32x4_ps(high[i], 2));
    _mm_store_ps(to + 96, _mm512_extractf32x4_ps(low[i], 3));
    _mm_store_ps(to + 100, _mm512_extractf32x4_ps(high[i], 3));
  }
}

#elif defined(__AVX2__)

/// Transposes an 8x8 matrix.
inline void transpose(__m256 r[8]) {
  __m256 pair[8];
  for (int i = 0; i < 4; ++i) {
    pair[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
    pair[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
  }
  __m256 quad[8];
  for (int i = 0; i < 2; ++i) {
    const __m256* p = pair + 4 * i;
    quad[4 * i] = _mm256_shuffle_ps(p[0], p[2], 0x44);
    quad[4 * i + 1] = _mm256_shuffle_ps(p[0], p[2], 0xEE);
    quad[4 * i + 2] = _mm256_shuffle_ps(p[1], p[3], 0x44);
    quad[4 * i + 3] = _mm256_shuffle_ps(p[1], p[3], 0xEE);
  }
  for (int i = 0; i < 4; ++i) {
    r[i] = _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x20);
    r[i + 4] = _mm256_permute2f128_ps(quad[i], quad[i + 4], 0x31);
  }
}

[[maybe_unused]] inline RecordLanes load_records(const float* base, Ints index) {
  alignas(32) std::int32_t at[kLanes];
  __builtin_memcpy(at, &index, sizeof(at));
  asm("" : "+m"(at));  // through memory: extracting lanes would occupy the shuffle port
  __m256 r[8];
  for (int i = 0; i < 8; ++i) r[i] = _mm256_load_ps(base + 8L * at[i]);
  transpose(r);
  RecordLanes result;
  for (int i = 0; i < 8; ++i) result.of[i] = (Floats)r[i];
  return result;
}

/// Writes the kLanes records contiguously.
[[maybe_unused]] inline void store_records(const RecordLanes& members, float* to) {
  __m256 r[8];
  for (int i = 0; i < 8; ++i) r[i] = (__m256)members.of[i];
  transpose(r);
  for (int i = 0; i < 8; ++i) _mm256_store_ps(to + 8 * i, r[i]);
}

#else

[[maybe_unused]] inline RecordLanes load_records(const float* base, Ints index) {
  RecordLanes result;
  for (int i = 0; i < kLanes; ++i) {
    for (int m = 0; m < 8; ++m) result.of[m][i] = base[8 * index[i] + m];
  }
  return result;
}

/// Writes the kLanes records contiguously.
[[maybe_unused]] inline void store_records(const RecordLanes& members, float* to) {
  for (int i = 0; i < kLanes; ++i) {
    for (int m = 0; m < 8; ++m) to[8 * i + m] = members.of[m][i];
  }
}

#endif

}  // namespace
}  // namespace pcavr
