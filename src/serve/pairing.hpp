// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// Who may come in: a code that is shown where the server runs, a token for who knows it.
/// Thread-safe; secrets are compared in constant time. Times [s] of any clock that ascends.
class Pairing {
 public:
  /// Fails where the system's random source does.
  [[nodiscard]] static Expected<Pairing> create();
  Pairing(Pairing&& other) noexcept;

  /// Six letters and digits that cannot be taken for each other.
  [[nodiscard]] const std::string& code() const { return code_; }

  enum class Outcome { paired, wrong, too_many_tries };
  struct Answer {
    Outcome outcome = Outcome::wrong;
    std::string token;  ///< where paired
  };
  /// Blanks, hyphens and small letters in `code` do not matter. `address` is where it came from:
  /// five tries a minute for each, thirty for all.
  [[nodiscard]] Expected<Answer> pair(std::string_view code, const std::string& address,
                                      double now);
  [[nodiscard]] bool is_paired(std::string_view token) const;

 private:
  explicit Pairing(std::string code) : code_(std::move(code)) {}
  [[nodiscard]] bool may_try(const std::string& address, double now);

  std::string code_;
  mutable std::mutex mutex_;
  std::vector<std::string> tokens_;                   ///< newest last
  std::map<std::string, std::vector<double>> tries_;  ///< [s] by address, of the last minute
};

}  // namespace pcavr
