// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pairing.hpp"

#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include <sys/random.h>

namespace pcavr {
namespace {

// 32 signs, so that each takes five bits and all are equally likely; no 0 O 1 I.
constexpr std::string_view kSigns = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789";
// 30 bits: at thirty tries a minute, half of them takes 34 years.
constexpr std::size_t kCodeLength = 6;
constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kMaxTokens = 64;
constexpr double kMinute = 60.0;
constexpr std::size_t kTriesOfOne = 5;
constexpr std::size_t kTriesOfAll = 30;

Expected<void> fill_at_random(std::span<std::uint8_t> bytes) {
  // Up to 256 bytes come at once, or not at all.
  if (::getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size())) return {};
  return Error{.message =
                   std::string("no random numbers from the system: ") + std::strerror(errno)};
}

bool are_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

std::string as_written(std::string_view code) {
  std::string plain;
  for (const char sign : code.substr(0, 4 * kCodeLength)) {
    if (sign == ' ' || sign == '-') continue;
    plain += static_cast<char>(std::toupper(static_cast<unsigned char>(sign)));
  }
  return plain;
}

Expected<std::string> new_token() {
  std::array<std::uint8_t, kTokenBytes> bytes{};
  const Expected<void> filled = fill_at_random(bytes);
  if (!filled) return filled.error();
  std::string token;
  for (const std::uint8_t byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

}  // namespace

Expected<Pairing> Pairing::create() {
  std::array<std::uint8_t, kCodeLength> bytes{};
  const Expected<void> filled = fill_at_random(bytes);
  if (!filled) return filled.error();
  std::string code;
  for (const std::uint8_t byte : bytes) code += kSigns[byte % kSigns.size()];
  return Pairing(std::move(code));
}

Pairing::Pairing(Pairing&& other) noexcept
    : code_(std::move(other.code_)),
      tokens_(std::move(other.tokens_)),
      tries_(std::move(other.tries_)) {}

bool Pairing::may_try(const std::string& address, double now) {
  std::size_t of_all = 0;
  for (auto place = tries_.begin(); place != tries_.end();) {
    std::erase_if(place->second, [&](double t) { return now - t > kMinute; });
    of_all += place->second.size();
    place = place->second.empty() ? tries_.erase(place) : std::next(place);
  }
  if (of_all >= kTriesOfAll) return false;
  std::vector<double>& of_one = tries_[address];
  if (of_one.size() >= kTriesOfOne) return false;
  of_one.push_back(now);
  return true;
}

Expected<Pairing::Answer> Pairing::pair(std::string_view code, const std::string& address,
                                        double now) {
  const std::lock_guard lock(mutex_);
  if (!may_try(address, now)) return Answer{Outcome::too_many_tries, {}};
  if (!are_equal(as_written(code), code_)) return Answer{Outcome::wrong, {}};
  Expected<std::string> token = new_token();
  if (!token) return token.error();
  if (tokens_.size() >= kMaxTokens) tokens_.erase(tokens_.begin());
  tokens_.push_back(*token);
  return Answer{Outcome::paired, std::move(*token)};
}

bool Pairing::is_paired(std::string_view token) const {
  const std::lock_guard lock(mutex_);
  bool is_known = false;
  for (const std::string& known : tokens_) is_known = are_equal(token, known) || is_known;
  return is_known;
}

}  // namespace pcavr
