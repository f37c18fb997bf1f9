// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// Limit of one record and one unpacked chunk, to bound memory for damaged files [bytes].
inline constexpr std::uint64_t kMaxBagRecord = std::uint64_t{1} << 30;

enum class Compression { none, zstd, lz4, bz2 };

/// The compression of a chunk by its name in the file; an Error, without file, for an unknown one.
[[nodiscard]] Expected<Compression> parse_compression(std::string_view name);

/// Receives decompressed bytes, piece by piece; returns false to stop.
using ByteSink = std::function<bool(std::span<const std::uint8_t>)>;
/// Delivers the next compressed bytes; empty at the end.
using ByteFeed = std::function<Expected<std::span<const std::uint8_t>>()>;

/// Streams from `feed` to `sink`; concatenated streams are one. An Error (without file) for damaged
/// data and for data that ends early; what could be decompressed has been delivered before.
[[nodiscard]] Expected<void> decompress_stream(Compression compression, const ByteFeed& feed,
                                               const ByteSink& sink);

struct DecompressLimits {
  std::uint64_t size = 0;   ///< [bytes] stated; a different one is an Error
  bool may_be_cut = false;  ///< returns what is there where the data ends early
};

/// Decompresses a chunk into `bytes`, whose memory is reused. Errors have no file.
[[nodiscard]] Expected<void> decompress_chunk(Compression compression,
                                              std::span<const std::uint8_t> packed,
                                              const DecompressLimits& limits,
                                              std::vector<std::uint8_t>& bytes);

}  // namespace pcavr
