// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/near_names.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace pcavr {
namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Insertions, deletions and replacements between two names [Levenshtein 1966].
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string near_names_hint(const std::string& name, const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNames = 4;
  constexpr std::size_t kMaxLength = 200;
  if (names.empty()) return "there is none of its kind";
  std::vector<std::pair<std::size_t, std::string>> ranked;
  const std::string wanted = lower_case(name.substr(0, kMaxLength));
  for (const std::string& other : names) {
    if (other.empty()) continue;
    const std::string there = lower_case(other.substr(0, kMaxLength));
    const bool is_part = !wanted.empty() && there.find(wanted) != there.npos;
    ranked.emplace_back(is_part ? 0 : edit_distance(wanted, there), other);
  }
  std::sort(ranked.begin(), ranked.end());
  std::string text = "near matches: ";
  for (std::size_t i = 0; i < std::min(kMaxNames, ranked.size()); ++i) {
    text += (i > 0 ? ", " : "") + ranked[i].second;
  }
  return text;
}

}  // namespace pcavr
