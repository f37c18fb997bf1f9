// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#ifdef __AVX2__
#include <immintrin.h>
#endif

// Eight lanes of 32 bits, as GCC's and clang's vector types. Everything has internal linkage: the
// files that include this are compiled for different instruction sets, and no code for one may end
// up in another's place.
namespace pcavr {
namespace {

using Floats = float __attribute__((vector_size(32)));
using Ints = std::int32_t __attribute__((vector_size(32)));
using Words = std::uint32_t __attribute__((vector_size(32)));

constexpr int kLanes = 8;

[[maybe_unused]] inline Floats splat(float value) { return Floats{} + value; }
[[maybe_unused]] inline Floats lane_numbers() { return Floats{0, 1, 2, 3, 4, 5, 6, 7}; }
[[maybe_unused]] inline Floats to_floats(Ints value) {
  return __builtin_convertvector(value, Floats);
}
/// Towards zero.
[[maybe_unused]] inline Ints to_ints(Floats value) { return __builtin_convertvector(value, Ints); }

[[maybe_unused]] inline Floats masked(Ints mask, Floats value) {
  return (Floats)(mask & (Ints)value);
}
[[maybe_unused]] inline Ints select(Ints mask, Ints yes, Ints no) {
  return (mask & yes) | (~mask & no);
}
[[maybe_unused]] inline Floats select(Ints mask, Floats yes, Floats no) {
  return (Floats)select(mask, (Ints)yes, (Ints)no);
}
[[maybe_unused]] inline Floats smaller(Floats a, Floats b) { return select(a < b, a, b); }
[[maybe_unused]] inline Floats larger(Floats a, Floats b) { return select(a > b, a, b); }

/// To the nearest whole number, halves away from zero.
[[maybe_unused]] inline Floats rounded(Floats value) {
  const Floats half = select(value < 0.0F, splat(-0.5F), splat(0.5F));
  return to_floats(to_ints(value + half));
}

[[maybe_unused]] inline Floats square_root(Floats value) {
#ifdef __AVX2__
  return (Floats)_mm256_sqrt_ps((__m256)value);
#else
  for (int i = 0; i < kLanes; ++i) value[i] = __builtin_sqrtf(value[i]);
  return value;
#endif
}

[[maybe_unused]] inline bool any(Ints mask) {
#ifdef __AVX2__
  return _mm256_movemask_ps((__m256)mask) != 0;
#else
  std::int32_t bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= mask[i];
  return bits != 0;
#endif
}

[[maybe_unused]] inline Floats load(const float* from) {
  Floats value;
  __builtin_memcpy(&value, from, sizeof(value));
  return value;
}

[[maybe_unused]] inline Floats gather(const float* base, Ints index) {
#ifdef __AVX2__
  return (Floats)_mm256_i32gather_ps(base, (__m256i)index, 4);
#else
  Floats result;
  for (int i = 0; i < kLanes; ++i) result[i] = base[index[i]];
  return result;
#endif
}

/// Eight records of eight numbers, turned: result[i] holds number i of every record.
struct EightMembers {
  Floats of[8];
};

[[maybe_unused]] inline EightMembers load_records(const float* base, Ints index) {
  EightMembers result;
#ifdef __AVX2__
  // Loads and shuffles: a gather for each member would touch every record eight times.
  __m256 r[8];
  for (int i = 0; i < kLanes; ++i) r[i] = _mm256_load_ps(base + 8 * index[i]);
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
    result.of[i] = (Floats)_mm256_permute2f128_ps(quad[i], quad[i + 4], 0x20);
    result.of[i + 4] = (Floats)_mm256_permute2f128_ps(quad[i], quad[i + 4], 0x31);
  }
#else
  for (int i = 0; i < kLanes; ++i) {
    for (int m = 0; m < 8; ++m) result.of[m][i] = base[8 * index[i] + m];
  }
#endif
  return result;
}

}  // namespace
}  // namespace pcavr
