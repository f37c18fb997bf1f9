// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>

namespace pcavr {

/// The N of a path such as "/api/frames/N.jpg", written as a plain number.
[[nodiscard]] inline std::optional<std::size_t> number_in(std::string_view path,
                                                          std::string_view start,
                                                          std::string_view end) {
  if (!path.starts_with(start) || !path.ends_with(end)) return std::nullopt;
  path.remove_prefix(start.size());
  if (path.size() <= end.size()) return std::nullopt;
  path.remove_suffix(end.size());
  std::size_t number = 0;
  const auto read = std::from_chars(path.data(), path.data() + path.size(), number);
  const bool is_plain = read.ec == std::errc() && read.ptr == path.data() + path.size();
  if (!is_plain || (path.size() > 1 && path.front() == '0')) return std::nullopt;
  return number;
}

}  // namespace pcavr
