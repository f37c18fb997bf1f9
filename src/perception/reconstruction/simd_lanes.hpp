// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#ifdef __AVX2__
#include <immintrin.h>
#endif

// Lanes of 32 bits, as GCC's and clang's vector types: sixteen with AVX-512, otherwise eight.
// Everything has internal linkage: the files that include this are compiled for different
// instruction sets, and the linker must not merge their functions.
namespace pcavr {
namespace {

#ifdef __AVX512F__
constexpr int kLanes = 16;
#else
constexpr int kLanes = 8;
#endif

using Floats = float __attribute__((vector_size(kLanes * 4)));
using Ints = std::int32_t __attribute__((vector_size(kLanes * 4)));
using Words = std::uint32_t __attribute__((vector_size(kLanes * 4)));

[[maybe_unused]] inline Floats splat(float value) { return Floats{} + value; }
[[maybe_unused]] inline Words lane_numbers() {
#ifdef __AVX512F__
  return Words{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#else
  return Words{0, 1, 2, 3, 4, 5, 6, 7};
#endif
}
[[maybe_unused]] inline Floats to_floats(Ints value) {
  return __builtin_convertvector(value, Floats);
}
/// Truncates towards zero.
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
// Both give b for NaN, like the instructions.
[[maybe_unused]] inline Floats lane_min(Floats a, Floats b) {
#if defined(__AVX512F__)
  return (Floats)_mm512_min_ps((__m512)a, (__m512)b);
#elif defined(__AVX2__)
  return (Floats)_mm256_min_ps((__m256)a, (__m256)b);
#else
  return select(a < b, a, b);
#endif
}
[[maybe_unused]] inline Floats lane_max(Floats a, Floats b) {
#if defined(__AVX512F__)
  return (Floats)_mm512_max_ps((__m512)a, (__m512)b);
#elif defined(__AVX2__)
  return (Floats)_mm256_max_ps((__m256)a, (__m256)b);
#else
  return select(a > b, a, b);
#endif
}
[[maybe_unused]] inline Ints lane_min(Ints a, Ints b) { return select(a < b, a, b); }
[[maybe_unused]] inline Ints lane_max(Ints a, Ints b) { return select(a > b, a, b); }

/// Rounds to the nearest integer, halves away from zero.
[[maybe_unused]] inline Ints rounded(Floats value) {
  const Ints sign = (Ints)value & INT32_MIN;
  return to_ints(value + (Floats)(sign | (Ints)splat(0.5F)));
}

[[maybe_unused]] inline Floats square_root(Floats value) {
#if defined(__AVX512F__)
  return (Floats)_mm512_sqrt_ps((__m512)value);
#elif defined(__AVX2__)
  return (Floats)_mm256_sqrt_ps((__m256)value);
#else
  for (int i = 0; i < kLanes; ++i) value[i] = __builtin_sqrtf(value[i]);
  return value;
#endif
}

[[maybe_unused]] inline bool any(Ints mask) {
#if defined(__AVX512F__)
  return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX2__)
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

/// The first `count` lanes; the others are 0.
[[maybe_unused]] inline Floats load_some(const float* from, int count) {
  Floats value = {};
  for (int i = 0; i < count; ++i) value[i] = from[i];
  return value;
}

[[maybe_unused]] inline void store(Floats value, float* to) {
  __builtin_memcpy(to, &value, sizeof(value));
}
[[maybe_unused]] inline void store_some(Floats value, int count, float* to) {
  for (int i = 0; i < count; ++i) to[i] = value[i];
}

/// The even lanes of a, followed by those of b.
[[maybe_unused]] inline Floats even_lanes(Floats a, Floats b) {
#ifdef __AVX512F__
  return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
#else
  return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
#endif
}
[[maybe_unused]] inline Floats odd_lanes(Floats a, Floats b) {
#ifdef __AVX512F__
  return __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
#else
  return __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#endif
}

[[maybe_unused]] inline Floats gather(const float* base, Ints index) {
#if defined(__AVX512F__)
  return (Floats)_mm512_i32gather_ps((__m512i)index, base, 4);
#elif defined(__AVX2__)
  return (Floats)_mm256_i32gather_ps(base, (__m256i)index, 4);
#else
  Floats result;
  for (int i = 0; i < kLanes; ++i) result[i] = base[index[i]];
  return result;
#endif
}

/// Four bytes from each byte offset.
[[maybe_unused]] inline Ints gather_bytes(const std::uint8_t* base, Ints offset) {
#if defined(__AVX512F__)
  return (Ints)_mm512_i32gather_epi32((__m512i)offset, base, 1);
#elif defined(__AVX2__)
  return (Ints)_mm256_i32gather_epi32(reinterpret_cast<const int*>(base), (__m256i)offset, 1);
#else
  std::int32_t lanes[kLanes];
  for (int i = 0; i < kLanes; ++i) __builtin_memcpy(lanes + i, base + offset[i], 4);
  Ints result;
  __builtin_memcpy(&result, lanes, sizeof(result));
  return result;
#endif
}

}  // namespace
}  // namespace pcavr
