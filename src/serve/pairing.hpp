// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Authentication of pages by a pairing code, which is shown where the server runs, and session
/// tokens for those who sent it. Rate-limited; secrets are compared in constant time. Thread-safe.
/// Times [s] of any monotonic clock.
class Pairing {
 public:
  /// An Error if the system's random source fails.
  [[nodiscard]] static Expected<Pairing> create();
  Pairing(Pairing&& other) noexcept;

  /// Six letters and digits that can't be confused with each other.
  [[nodiscard]] const std::string& code() const { return code_; }

  enum class Outcome { paired, wrong, too_many_attempts };
  struct Answer {
    Outcome outcome = Outcome::wrong;
    std::string token;  ///< if paired
  };
  /// Spaces, hyphens and case in `code` are ignored. `address` is the client's. Rate limit: five
  /// attempts a minute for each address (IPv6: each /64), thirty for all, except for the first one
  /// of each.
  [[nodiscard]] Expected<Answer> pair(std::string_view code, const std::string& address,
                                      double now);
  [[nodiscard]] bool is_paired(std::string_view token) const;

 private:
  explicit Pairing(std::string code) : code_(std::move(code)) {}
  [[nodiscard]] bool is_within_rate_limit(const std::string& address, double now);

  std::string code_;
  mutable std::mutex mutex_;
  std::vector<std::string> tokens_;                      ///< newest last
  std::map<std::string, std::vector<double>> attempts_;  ///< [s] by address, of the last minute
};

}  // namespace pcavr
