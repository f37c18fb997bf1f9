// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/serve/content.hpp"

#include "serve/gzip.hpp"

namespace pcavr {

/// The uncompressed body of a path; empty and a failed test if there is none.
inline std::string body_of(const ContentSource& source, std::string_view path) {
  const auto content = source.find(path);
  if (!content || !*content) {
    ADD_FAILURE() << path << ": " << (content ? "no such path" : content.error().to_string());
    return {};
  }
  if (!(**content).is_gzipped) return (**content).body;
  return gunzip((**content).body, std::size_t{1} << 28).value_or("");
}

inline nlohmann::json json_of(const ContentSource& source, std::string_view path) {
  return nlohmann::json::parse(body_of(source, path), nullptr, false);
}

inline bool has_path(const ContentSource& source, std::string_view path) {
  const auto content = source.find(path);
  return content && *content;
}

/// Bytes for a ByteReader; `text` must outlive it.
inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace pcavr
