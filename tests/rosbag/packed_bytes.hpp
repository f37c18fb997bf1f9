// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

#include "recordings/rosbag/decompression.hpp"

namespace pcavr::test {

/// The bytes as one stream of the compression.
inline std::string packed_bytes(Compression compression, const std::string& bytes) {
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

}  // namespace pcavr::test
