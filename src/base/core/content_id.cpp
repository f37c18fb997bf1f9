// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/content_id.hpp"

#include <fmt/format.h>

namespace pcavr {

std::uint64_t fnv1a(std::span<const std::byte> bytes, std::uint64_t before) {
  std::uint64_t hash = before;
  for (const std::byte byte : bytes) {
    hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211ULL;
  }
  return hash;
}

std::string content_id(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

bool is_content_id(std::string_view text) {
  return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace pcavr
