// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace pcavr {

/// SHA-256 [FIPS 180-4] of bytes that are added one after the other, by OpenSSL.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// Adds a text with its length, so that "ab", "c" differs from "a", "bc".
  void add_text(std::string_view text);
  /// 64 hexadecimal digits. Call once, at the end.
  [[nodiscard]] std::string digest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
