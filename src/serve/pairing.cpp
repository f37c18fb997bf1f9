// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pairing.hpp"

#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <span>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/random.h>

namespace pcavr {
namespace {

// 32 characters, so that each takes five bits and all are equally likely; no 0 O 1 I.
constexpr std::string_view kAlphabet = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789";
// 30 bits: at thirty attempts a minute, trying half of the codes takes 34 years; see kMaxAttempts.
constexpr std::size_t kCodeLength = 6;
constexpr std::size_t kTokenBytes = 32;            // 256 bits: cannot be guessed
constexpr std::size_t kMaxTokens = 64;             // twice the pages at the same time
constexpr double kMinute = 60.0;                   // [s]
constexpr std::size_t kMaxAttemptsPerAddress = 5;  // a minute: enough for typing errors
// A minute, of all addresses, except for the first one of each: a network of 250 machines has 280,
// and needs four years to try half of the codes.
constexpr std::size_t kMaxAttempts = 30;
constexpr std::size_t kNetworkBytes = 8;  // of an IPv6 address

Expected<void> fill_with_random(std::span<std::uint8_t> bytes) {
  // getrandom() fills up to 256 bytes at once, or fails.
  if (::getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size())) return {};
  return Error{.message =
                   std::string("the system gave no random numbers: ") + std::strerror(errno)};
}

/// Compares in constant time, against timing attacks.
bool are_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

std::string normalized(std::string_view code) {
  std::string plain;
  for (const char c : code.substr(0, 4 * kCodeLength)) {
    if (c == ' ' || c == '-') continue;
    plain += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return plain;
}

Expected<std::string> new_token() {
  std::array<std::uint8_t, kTokenBytes> bytes{};
  const Expected<void> filled = fill_with_random(bytes);
  if (!filled) return filled.error();
  std::string token;
  for (const std::uint8_t byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

/// One subscriber has all the addresses of an IPv6 network of 64 bits.
std::string network_of(const std::string& address) {
  in6_addr whole{};
  const std::string plain = address.substr(0, address.find('%'));
  if (::inet_pton(AF_INET6, plain.c_str(), &whole) != 1 || IN6_IS_ADDR_V4MAPPED(&whole) != 0) {
    return address;
  }
  return {std::begin(whole.s6_addr), std::begin(whole.s6_addr) + kNetworkBytes};
}

}  // namespace

Expected<Pairing> Pairing::create() {
  std::array<std::uint8_t, kCodeLength> bytes{};
  const Expected<void> filled = fill_with_random(bytes);
  if (!filled) return filled.error();
  std::string code;
  for (const std::uint8_t byte : bytes) code += kAlphabet[byte % kAlphabet.size()];
  return Pairing(std::move(code));
}

Pairing::Pairing(Pairing&& other) noexcept
    : code_(std::move(other.code_)),
      tokens_(std::move(other.tokens_)),
      attempts_(std::move(other.attempts_)) {}

bool Pairing::is_within_rate_limit(const std::string& address, double now) {
  std::size_t count = 0;
  for (auto entry = attempts_.begin(); entry != attempts_.end();) {
    std::erase_if(entry->second, [&](double t) { return now - t > kMinute; });
    count += entry->second.size();
    entry = entry->second.empty() ? attempts_.erase(entry) : std::next(entry);
  }
  std::vector<double>& own = attempts_[network_of(address)];
  if (own.size() >= kMaxAttemptsPerAddress) return false;
  // Others can't keep anyone from a first attempt.
  if (!own.empty() && count >= kMaxAttempts) return false;
  own.push_back(now);
  return true;
}

Expected<Pairing::Answer> Pairing::pair(std::string_view code, const std::string& address,
                                        double now) {
  const std::lock_guard lock(mutex_);
  if (!is_within_rate_limit(address, now)) return Answer{Outcome::too_many_attempts, {}};
  if (!are_equal(normalized(code), code_)) return Answer{Outcome::wrong, {}};
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
