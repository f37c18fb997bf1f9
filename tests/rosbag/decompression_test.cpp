// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/decompression.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rosbag/packed_bytes.hpp"
#include "support/read_bag.hpp"

namespace pcavr {
namespace {

/// Two megabytes that compress well, but not to nothing.
std::string some_bytes() {
  std::string bytes;
  unsigned state = 1;
  while (bytes.size() < 2'000'000) {
    state = state * 1664525U + 1013904223U;
    bytes += std::to_string(state >> 8U);
  }
  return bytes;
}

class Decompress : public testing::TestWithParam<Compression> {};

TEST_P(Decompress, ReturnsTheOriginal) {
  const std::string original = some_bytes();
  const std::string packed = test::packed_bytes(GetParam(), original);
  ASSERT_LT(packed.size(), original.size());
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(
      decompress_chunk(GetParam(), test::bytes_of(packed), {.size = original.size()}, bytes));
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), original);
  EXPECT_FALSE(decompress_chunk(GetParam(), test::bytes_of(packed), {.size = 1000}, bytes));
  EXPECT_LE(bytes.size(), 1'000'000U) << "decompresses on beyond the stated size";
}

TEST_P(Decompress, ReturnsWhatIsThereOfCutData) {
  const std::string original = some_bytes();
  const std::string packed = test::packed_bytes(GetParam(), original);
  const auto half = test::bytes_of(packed).first(packed.size() / 2);
  std::vector<std::uint8_t> bytes;
  EXPECT_FALSE(decompress_chunk(GetParam(), half, {.size = original.size()}, bytes));
  ASSERT_TRUE(
      decompress_chunk(GetParam(), half, {.size = original.size(), .may_be_cut = true}, bytes));
  EXPECT_GT(bytes.size(), original.size() / 4);
  EXPECT_TRUE(original.starts_with(std::string(bytes.begin(), bytes.end())));
}

/// Each piece follows the one before; the end stays the end.
TEST_P(Decompress, DeliversAsManyBytesAsAreWanted) {
  const std::string original = some_bytes();
  const std::string packed = test::packed_bytes(GetParam(), original + original);
  std::size_t fed = 0;
  UnpackedStream stream(GetParam(), [&]() -> Expected<std::span<const std::uint8_t>> {
    const std::size_t size = std::min<std::size_t>(packed.size() - fed, 10'000);
    fed += size;
    return test::bytes_of(packed).subspan(fed - size, size);
  });
  std::string bytes;
  for (std::size_t wanted = 1; bytes.size() < 2 * original.size(); wanted = 3 * wanted + 1) {
    std::vector<std::uint8_t> piece(std::min<std::size_t>(wanted, 777'777));
    const Expected<std::size_t> got = stream.read(piece);
    ASSERT_TRUE(got && *got > 0);
    bytes.append(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(*got));
  }
  EXPECT_EQ(bytes, original + original);
  std::vector<std::uint8_t> more(5);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(*stream.read(more), 0U);
}

INSTANTIATE_TEST_SUITE_P(Libraries, Decompress,
                         testing::Values(Compression::zstd, Compression::lz4, Compression::bz2));

}  // namespace
}  // namespace pcavr
