// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"

#include "rosbag/open_file.hpp"

namespace pcavr {

/// The bytes of a file, read by parts, or bytes in memory.
class ByteSource {
 public:
  /// `name` is the file's in errors; the path itself where empty.
  [[nodiscard]] static Expected<ByteSource> open(const std::filesystem::path& file,
                                                 const std::string& name = {});
  /// The bytes must outlive the source.
  ByteSource(std::span<const std::uint8_t> bytes, std::string name)
      : bytes_(bytes), size_(bytes.size()), name_(std::move(name)) {}

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// `count` bytes at `offset`, which must lie inside (otherwise a ContractError). Valid until the
  /// next call.
  [[nodiscard]] Expected<std::span<const std::uint8_t>> view(std::uint64_t offset,
                                                             std::size_t count);

  /// An Error about the byte at `offset`.
  [[nodiscard]] Error error_at(std::uint64_t offset, std::string message,
                               std::string hint = {}) const;

 private:
  ByteSource() = default;
  [[nodiscard]] Expected<void> fill(std::uint64_t offset, std::size_t count);

  std::span<const std::uint8_t> bytes_;
  OpenFile file_;
  std::vector<std::uint8_t> window_;
  std::uint64_t window_begin_ = 0;
  std::size_t window_size_ = 0;
  std::uint64_t size_ = 0;
  std::string name_;
};

}  // namespace pcavr
