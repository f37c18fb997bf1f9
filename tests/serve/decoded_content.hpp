// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/serve/content.hpp"

#include "scene/bytes.hpp"
#include "serve/gzip.hpp"

namespace pcavr {

/// What a browser gets of a path, gzip undone; empty and a failed test where there is nothing.
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

/// Reads numbers one after the other; at the end it throws.
class ByteReader {
 public:
  explicit ByteReader(std::string bytes) : bytes_(std::move(bytes)) {}

  template <typename Value>
  Value next() {
    if (at_ + sizeof(Value) > bytes_.size()) throw std::out_of_range("the bytes end too early");
    const auto value = value_at<Value>(bytes_.data(), at_);
    at_ += sizeof(Value);
    return value;
  }
  [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace pcavr
