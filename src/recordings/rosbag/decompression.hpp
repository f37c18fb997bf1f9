// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Limit of one record and one unpacked chunk, to bound memory for damaged files [bytes].
inline constexpr std::uint64_t kMaxBagRecord = std::uint64_t{1} << 30;

enum class Compression { none, zstd, lz4, bz2 };

/// The compression of a chunk by its name in the file; an Error, without file, for an unknown one.
[[nodiscard]] Expected<Compression> parse_compression(std::string_view name);

/// The most that packed data of a size [bytes] may expand to. Recordings pack to a hundredth at
/// best, and a few constant images to less: what expands beyond was made to fill memory or disk.
[[nodiscard]] std::uint64_t max_unpacked_size(std::uint64_t packed_size);

/// Receives decompressed bytes, piece by piece; returns false to stop.
using ByteSink = std::function<bool(std::span<const std::uint8_t>)>;
/// Delivers the next compressed bytes; empty at the end.
using ByteFeed = std::function<Expected<std::span<const std::uint8_t>>()>;

class Decompressor;

/// Decompressed bytes, as many at a time as are wanted. Concatenated streams are one.
class UnpackedStream {
 public:
  UnpackedStream(Compression compression, ByteFeed feed);
  UnpackedStream(UnpackedStream&&) noexcept;
  ~UnpackedStream();

  /// Writes the next bytes to `out` and returns their number, which is 0 at the end only. An Error
  /// (without file) for damaged data and for data that ends early, after all bytes before it.
  [[nodiscard]] Expected<std::size_t> read(std::span<std::uint8_t> out);

 private:
  [[nodiscard]] Expected<std::size_t> step(std::span<std::uint8_t> out);

  ByteFeed feed_;
  std::unique_ptr<Decompressor> decompressor_;
  std::span<const std::uint8_t> rest_;  ///< of what was fed
  std::optional<Error> error_ = {};     ///< met after the bytes that the last call returned
  bool has_more_output_ = false;        ///< without further input
  bool is_between_streams_ = true;
  bool is_end_ = false;
};

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
