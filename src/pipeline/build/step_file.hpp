// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The files between the steps of a build by tiles: numbers as this machine has them, and the
// SHA-256 of all before it at the end. What is read is to the bit what was written, and a type's
// fields are listed once, for both (tile_fields.hpp).
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/pipeline/tile_steps.hpp"

#include "pipeline/jobs/sha256.hpp"

namespace pcavr {

/// Types that are written as their bytes, without padding.
template <typename T>
inline constexpr bool kIsPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <>
inline constexpr bool kIsPlain<Rgb8> = true;
template <typename T, std::size_t kCount>
inline constexpr bool kIsPlain<std::array<T, kCount>> = kIsPlain<T>;
template <typename T, int kRows, int kColumns>
inline constexpr bool kIsPlain<Eigen::Matrix<T, kRows, kColumns>> =
    kRows > 0 && kColumns > 0 && kIsPlain<T>;

template <typename T, typename U>
concept Of = std::same_as<std::remove_const_t<T>, U>;

/// Writes a file in parts.
class StepFileWriter {
 public:
  static constexpr bool kReads = false;

  StepFileWriter(std::string_view format, const WriteContent& write);

  template <typename T>
  void operator()(const T& value) {
    if constexpr (kIsPlain<T>) {
      add_bytes({reinterpret_cast<const char*>(&value), sizeof(T)});
    } else {
      transfer(*this, value);
    }
  }
  void add_bytes(std::string_view bytes);
  /// Whether all writes succeeded so far.
  [[nodiscard]] const Expected<void>& written() const { return written_; }
  /// Writes the rest and the digest, which it returns, or the first Error. Call once, at the end.
  [[nodiscard]] Expected<std::string> finish();

 private:
  void flush();

  const WriteContent& write_;
  std::string buffer_;
  Sha256 hash_;
  Expected<void> written_;
};

/// Reads one. Throws std::out_of_range where the file ends before a value, or has more values than
/// bytes are left.
class StepFileReader {
 public:
  static constexpr bool kReads = true;

  /// An Error where the file is none of this format, or is damaged: all of it is read for its
  /// digest.
  [[nodiscard]] static Expected<StepFileReader> open(const std::filesystem::path& file,
                                                     std::string_view format);

  template <typename T>
  void operator()(T& value) {
    if constexpr (kIsPlain<T>) {
      take_bytes(reinterpret_cast<char*>(&value), sizeof(T));
    } else {
      transfer(*this, value);
    }
  }
  void take_bytes(char* bytes, std::size_t size);
  /// A count of values of at least this size.
  [[nodiscard]] std::size_t take_count(std::size_t size);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& digest() const { return digest_; }

 private:
  StepFileReader() = default;

  std::filesystem::path path_;
  std::ifstream stream_;
  std::uint64_t left_ = 0;  ///< bytes before the digest
  std::string digest_;
};

template <typename T>
void transfer(StepFileWriter& file, const std::vector<T>& values) {
  file(std::uint64_t{values.size()});
  if constexpr (kIsPlain<T> && !std::same_as<T, bool>) {
    file.add_bytes({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  } else {
    for (const T& value : values) file(value);
  }
}
template <typename T>
void transfer(StepFileReader& file, std::vector<T>& values) {
  if constexpr (kIsPlain<T>) {
    values.resize(file.take_count(sizeof(T)));
    file.take_bytes(reinterpret_cast<char*>(values.data()), values.size() * sizeof(T));
  } else {
    const std::size_t count = file.take_count(1);
    for (std::size_t i = 0; i < count; ++i) file(values.emplace_back());
  }
}

inline void transfer(StepFileWriter& file, const std::string& text) {
  file(std::uint64_t{text.size()});
  file.add_bytes(text);
}
inline void transfer(StepFileReader& file, std::string& text) {
  text.resize(file.take_count(1));
  file.take_bytes(text.data(), text.size());
}

template <typename T>
void transfer(StepFileWriter& file, const std::optional<T>& value) {
  file(value.has_value());
  if (value) file(*value);
}
template <typename T>
void transfer(StepFileReader& file, std::optional<T>& value) {
  bool has_value = false;
  file(has_value);
  value.reset();
  if (has_value) file(value.emplace());
}

template <typename File, typename A, typename B>
void transfer(File& file, std::pair<A, B>& both) {
  file(both.first);
  file(both.second);
}
template <typename A, typename B>
void transfer(StepFileWriter& file, const std::pair<A, B>& both) {
  file(both.first);
  file(both.second);
}

template <typename Key, typename T>
void transfer(StepFileWriter& file, const std::map<Key, T>& values) {
  file(std::vector<std::pair<Key, T>>(values.begin(), values.end()));
}
template <typename Key, typename T>
void transfer(StepFileReader& file, std::map<Key, T>& values) {
  std::vector<std::pair<Key, T>> pairs;
  file(pairs);
  values = {pairs.begin(), pairs.end()};
}

template <typename T>
void transfer(StepFileWriter& file, const std::set<T>& values) {
  file(std::vector<T>(values.begin(), values.end()));
}
template <typename T>
void transfer(StepFileReader& file, std::set<T>& values) {
  std::vector<T> all;
  file(all);
  values = {all.begin(), all.end()};
}

}  // namespace pcavr
