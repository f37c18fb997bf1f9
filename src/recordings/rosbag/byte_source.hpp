// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/open_file.hpp"

namespace pcavr {

/// The bytes of a file, read by parts, or bytes in memory.
class ByteSource {
 public:
  /// `name` is the file's in errors; the path itself where empty.
  [[nodiscard]] static Expected<ByteSource> open(const std::filesystem::path& file,
                                                 const std::string& name = {});
  /// The unpacked bytes of a packed file, in flat memory: they can be read in ascending order only.
  /// In a damaged or cut file, the bytes before the damage count as the whole file. An Error where
  /// it expands beyond max_unpacked_size().
  [[nodiscard]] static Expected<ByteSource> open_packed(const std::filesystem::path& file,
                                                        Compression compression);
  /// The bytes must outlive the source.
  ByteSource(std::span<const std::uint8_t> bytes, std::string name);
  ByteSource(ByteSource&&) noexcept;
  ~ByteSource();

  /// Size of the file as it is stored [bytes].
  [[nodiscard]] std::uint64_t stored_size() const;
  [[nodiscard]] bool is_ascending() const { return packed_ != nullptr; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// The number of the `count` bytes at `offset` that exist.
  [[nodiscard]] Expected<std::uint64_t> available(std::uint64_t offset, std::uint64_t count);
  /// The same for bytes that are not read; those before their end can't be read any more.
  [[nodiscard]] Expected<std::uint64_t> skip(std::uint64_t offset, std::uint64_t count);
  /// `count` bytes at `offset`, which must be available (otherwise a ContractError). Valid until
  /// the next call of a member.
  [[nodiscard]] Expected<std::span<const std::uint8_t>> view(std::uint64_t offset,
                                                             std::size_t count);

  /// An Error about the byte at `offset`.
  [[nodiscard]] Error error_at(std::uint64_t offset, std::string message,
                               std::string hint = {}) const;

 private:
  struct Packed;

  explicit ByteSource(std::string name);
  [[nodiscard]] bool is_in_window(std::uint64_t offset, std::uint64_t count) const;
  [[nodiscard]] Expected<void> fill(std::uint64_t offset, std::size_t count);
  [[nodiscard]] Expected<void> unpack_to(std::uint64_t offset);
  [[nodiscard]] Expected<void> unpack_more(std::size_t count);

  std::span<const std::uint8_t> bytes_;
  OpenFile file_;
  std::unique_ptr<Packed> packed_;
  std::vector<std::uint8_t> window_;
  std::uint64_t window_begin_ = 0;
  std::size_t window_size_ = 0;
  std::uint64_t size_ = 0;  ///< of no meaning where packed
  std::string name_;
};

}  // namespace pcavr
