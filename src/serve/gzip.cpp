// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "gzip.hpp"

#include <cstdint>
#include <memory>
#include <new>

#include <libdeflate.h>

namespace pcavr {
namespace {

constexpr int kLevel = 9;            // compressed once, sent often
constexpr std::size_t kTrailer = 4;  // ISIZE: the uncompressed length, at the end of the file

struct FreeCompressor {
  void operator()(libdeflate_compressor* tool) const { libdeflate_free_compressor(tool); }
  void operator()(libdeflate_decompressor* tool) const { libdeflate_free_decompressor(tool); }
};

}  // namespace

std::string gzip(std::string_view plain) {
  const std::unique_ptr<libdeflate_compressor, FreeCompressor> tool(
      libdeflate_alloc_compressor(kLevel));
  if (!tool) throw std::bad_alloc();
  std::string compressed(libdeflate_gzip_compress_bound(tool.get(), plain.size()), '\0');
  compressed.resize(libdeflate_gzip_compress(tool.get(), plain.data(), plain.size(),
                                             compressed.data(), compressed.size()));
  return compressed;
}

std::optional<std::string> gunzip(std::string_view compressed, std::size_t max_bytes) {
  if (compressed.size() < kTrailer) return std::nullopt;
  std::size_t length = 0;
  for (std::size_t i = 0; i < kTrailer; ++i) {
    const auto byte = static_cast<std::uint8_t>(compressed[compressed.size() - kTrailer + i]);
    length |= std::size_t{byte} << (8 * i);
  }
  if (length > max_bytes) return std::nullopt;
  const std::unique_ptr<libdeflate_decompressor, FreeCompressor> tool(
      libdeflate_alloc_decompressor());
  if (!tool) throw std::bad_alloc();
  std::string plain(length, '\0');
  const libdeflate_result result = libdeflate_gzip_decompress(
      tool.get(), compressed.data(), compressed.size(), plain.data(), plain.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS) return std::nullopt;
  return plain;
}

}  // namespace pcavr
