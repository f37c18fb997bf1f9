// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "rosbag/decompression.hpp"

#include <string>
#include <vector>

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

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

std::string compress(Compression compression, const std::string& bytes) {
  std::string packed(bytes.size() + 100'000, '\0');
  std::size_t size = 0;
  if (compression == Compression::zstd) {
    size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  } else if (compression == Compression::lz4) {
    size = LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
  } else {
    auto written = static_cast<unsigned>(packed.size());
    std::string copy = bytes;
    EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &written, copy.data(),
                                       static_cast<unsigned>(copy.size()), 1, 0, 0),
              BZ_OK);
    size = written;
  }
  packed.resize(size);
  return packed;
}

class Decompress : public testing::TestWithParam<Compression> {};

TEST_P(Decompress, ReturnsTheOriginal) {
  const std::string original = some_bytes();
  const std::string packed = compress(GetParam(), original);
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
  const std::string packed = compress(GetParam(), original);
  const auto half = test::bytes_of(packed).first(packed.size() / 2);
  std::vector<std::uint8_t> bytes;
  EXPECT_FALSE(decompress_chunk(GetParam(), half, {.size = original.size()}, bytes));
  ASSERT_TRUE(
      decompress_chunk(GetParam(), half, {.size = original.size(), .may_be_cut = true}, bytes));
  EXPECT_GT(bytes.size(), original.size() / 4);
  EXPECT_TRUE(original.starts_with(std::string(bytes.begin(), bytes.end())));
}

INSTANTIATE_TEST_SUITE_P(Libraries, Decompress,
                         testing::Values(Compression::zstd, Compression::lz4, Compression::bz2));

}  // namespace
}  // namespace pcavr
