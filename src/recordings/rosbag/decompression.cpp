// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/decompression.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kPiece = 1U << 18;
constexpr std::uint64_t kMaxExpansion = 1000;
constexpr std::uint64_t kAlwaysAllowed = std::uint64_t{256} << 20;  // [bytes]

}  // namespace

/// One decompressor's state: consumes input and fills output.
class Decompressor {
 public:
  struct Step {
    std::size_t consumed = 0;
    std::size_t produced = 0;
    bool is_end = false;  ///< of a stream; another may follow
  };

  Decompressor() = default;
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  virtual ~Decompressor() = default;
  virtual Expected<Step> run(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) = 0;
};

namespace {

Error damaged(const char* library, const char* reason) {
  return {.message = std::string("compressed data is damaged (") + library + ": " + reason + ")",
          .hint = "copy the file again from its origin"};
}

class ZstdDecompressor final : public Decompressor {
 public:
  Expected<Step> run(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) override {
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{out.data(), out.size(), 0};
    const std::size_t code = ZSTD_decompressStream(stream_.get(), &output, &input);
    if (ZSTD_isError(code) != 0) return damaged("zstd", ZSTD_getErrorName(code));
    return Step{input.pos, output.pos, code == 0};
  }

 private:
  std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream_{ZSTD_createDStream(),
                                                                     &ZSTD_freeDStream};
};

class Lz4Decompressor final : public Decompressor {
 public:
  Lz4Decompressor() {
    const LZ4F_errorCode_t code = LZ4F_createDecompressionContext(&context_, LZ4F_VERSION);
    PCAVR_REQUIRE(LZ4F_isError(code) == 0);
  }
  ~Lz4Decompressor() override { LZ4F_freeDecompressionContext(context_); }

  Expected<Step> run(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) override {
    std::size_t consumed = in.size();
    std::size_t produced = out.size();
    const std::size_t code =
        LZ4F_decompress(context_, out.data(), &produced, in.data(), &consumed, nullptr);
    if (LZ4F_isError(code) != 0) return damaged("lz4", LZ4F_getErrorName(code));
    return Step{consumed, produced, code == 0};
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

class Bz2Decompressor final : public Decompressor {
 public:
  Bz2Decompressor() { start(); }
  ~Bz2Decompressor() override { BZ2_bzDecompressEnd(&stream_); }

  Expected<Step> run(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) override {
    if (is_finished_) {
      BZ2_bzDecompressEnd(&stream_);
      start();
    }
    // The library takes its input as char*, but does not write to it.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream_.avail_in = static_cast<unsigned>(in.size());
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(out.size());
    const int code = BZ2_bzDecompress(&stream_);
    if (code != BZ_OK && code != BZ_STREAM_END) return damaged("bz2", "not a bzip2 block");
    is_finished_ = code == BZ_STREAM_END;
    return Step{in.size() - stream_.avail_in, out.size() - stream_.avail_out, is_finished_};
  }

 private:
  void start() {
    stream_ = {};
    is_finished_ = false;
    const int code = BZ2_bzDecompressInit(&stream_, 0, 0);
    PCAVR_REQUIRE(code == BZ_OK, code);
  }

  bz_stream stream_{};
  bool is_finished_ = false;
};

std::unique_ptr<Decompressor> make_decompressor(Compression compression) {
  if (compression == Compression::zstd) return std::make_unique<ZstdDecompressor>();
  if (compression == Compression::lz4) return std::make_unique<Lz4Decompressor>();
  return std::make_unique<Bz2Decompressor>();
}

}  // namespace

Expected<Compression> parse_compression(std::string_view name) {
  if (name.empty() || name == "none") return Compression::none;
  if (name == "zstd") return Compression::zstd;
  if (name == "lz4") return Compression::lz4;
  if (name == "bz2") return Compression::bz2;
  return Error{.message = "compression '" + std::string(name.substr(0, 40)) + "' is not supported",
               .hint = "none, zstd, lz4 and bz2 are; convert the bag with its own tools"};
}

std::uint64_t max_unpacked_size(std::uint64_t packed_size) {
  constexpr std::uint64_t kMaxPacked = std::numeric_limits<std::uint64_t>::max() / kMaxExpansion;
  return std::max(kAlwaysAllowed, kMaxExpansion * std::min(packed_size, kMaxPacked));
}

UnpackedStream::UnpackedStream(Compression compression, ByteFeed feed)
    : feed_(std::move(feed)), decompressor_(make_decompressor(compression)) {}

UnpackedStream::UnpackedStream(UnpackedStream&&) noexcept = default;

UnpackedStream::~UnpackedStream() = default;

Expected<std::size_t> UnpackedStream::read(std::span<std::uint8_t> out) {
  if (error_) return *error_;
  std::size_t count = 0;
  while (count < out.size() && !is_end_) {
    const Expected<std::size_t> got = step(out.subspan(count));
    if (!got) {
      error_ = got.error();
      if (count == 0) return *error_;
      break;
    }
    count += *got;
  }
  return count;
}

Expected<std::size_t> UnpackedStream::step(std::span<std::uint8_t> out) {
  if (rest_.empty() && !has_more_output_) {
    const Expected<std::span<const std::uint8_t>> fed = feed_();
    if (!fed) return fed.error();
    rest_ = *fed;
    is_end_ = rest_.empty();
    if (is_end_ && !is_between_streams_) {
      return Error{.message = "compressed data ends early",
                   .hint = "the file is cut; copy it again"};
    }
    if (is_end_) return std::size_t{0};
  }
  const Expected<Decompressor::Step> done = decompressor_->run(rest_, out);
  if (!done) return done.error();
  is_between_streams_ = done->is_end;
  has_more_output_ = done->produced == out.size() && !done->is_end;
  const bool is_stuck = done->consumed == 0 && done->produced == 0;
  rest_ = rest_.subspan(is_stuck ? rest_.size() : done->consumed);
  return done->produced;
}

Expected<void> decompress_stream(Compression compression, const ByteFeed& feed,
                                 const ByteSink& sink) {
  UnpackedStream stream(compression, feed);
  std::vector<std::uint8_t> piece(kPiece);
  for (;;) {
    const Expected<std::size_t> got = stream.read(piece);
    if (!got) return got.error();
    if (*got == 0 || !sink(std::span(piece).first(*got))) return {};
  }
}

Expected<void> decompress_chunk(Compression compression, std::span<const std::uint8_t> packed,
                                const DecompressLimits& limits, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  if (compression == Compression::none) {
    bytes.assign(packed.begin(), packed.end());
  } else {
    bool is_fed = false;
    const auto feed = [&]() -> Expected<std::span<const std::uint8_t>> {
      if (is_fed) return std::span<const std::uint8_t>();
      is_fed = true;
      return packed;
    };
    // One byte more than is stated shows that there are more; growing would take twice the memory.
    bytes.reserve(static_cast<std::size_t>(limits.size) + 1);
    const auto sink = [&](std::span<const std::uint8_t> piece) {
      const auto kept = piece.first(std::min(piece.size(), bytes.capacity() - bytes.size()));
      bytes.insert(bytes.end(), kept.begin(), kept.end());
      return bytes.size() <= limits.size;
    };
    const Expected<void> done = decompress_stream(compression, feed, sink);
    if (!done && !limits.may_be_cut) return done;
  }
  if (bytes.size() == limits.size || (limits.may_be_cut && bytes.size() < limits.size)) return {};
  return Error{.message = "chunk has " +
                          (bytes.size() > limits.size ? "more than its "
                                                      : std::to_string(bytes.size()) + " of its ") +
                          std::to_string(limits.size) + " bytes",
               .hint = "the file is damaged; copy it again from its origin"};
}

}  // namespace pcavr
