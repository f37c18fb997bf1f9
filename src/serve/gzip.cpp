// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "gzip.hpp"

#include <cstdint>
#include <memory>
#include <new>

#include <libdeflate.h>

namespace pcavr {
namespace {

constexpr int kLevel = 9;
constexpr std::size_t kTrailer = 4;  // the length before, at the end of the file

struct FreeCompressor {
  void operator()(libdeflate_compressor* tool) const { libdeflate_free_compressor(tool); }
  void operator()(libdeflate_decompressor* tool) const { libdeflate_free_decompressor(tool); }
};

}  // namespace

std::string gzip(std::string_view plain) {
  const std::unique_ptr<libdeflate_compressor, FreeCompressor> tool(
      libdeflate_alloc_compressor(kLevel));
  if (!tool) throw std::bad_alloc();
  std::string packed(libdeflate_gzip_compress_bound(tool.get(), plain.size()), '\0');
  packed.resize(libdeflate_gzip_compress(tool.get(), plain.data(), plain.size(), packed.data(),
                                         packed.size()));
  return packed;
}

std::optional<std::string> gunzip(std::string_view packed, std::size_t most) {
  if (packed.size() < kTrailer) return std::nullopt;
  std::size_t length = 0;
  for (std::size_t i = 0; i < kTrailer; ++i) {
    const auto byte = static_cast<std::uint8_t>(packed[packed.size() - kTrailer + i]);
    length |= std::size_t{byte} << (8 * i);
  }
  if (length > most) return std::nullopt;
  const std::unique_ptr<libdeflate_decompressor, FreeCompressor> tool(
      libdeflate_alloc_decompressor());
  if (!tool) throw std::bad_alloc();
  std::string plain(length, '\0');
  const libdeflate_result result = libdeflate_gzip_decompress(
      tool.get(), packed.data(), packed.size(), plain.data(), plain.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS) return std::nullopt;
  return plain;
}

}  // namespace pcavr
