// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/teleoperation/sites/black_box.hpp"

namespace pcavr {
namespace {

std::string plain_part_of(const std::string& name) {
  std::string part;
  for (const char c : name) {
    part += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  // ROS 2 has no name that begins with a digit.
  const bool has_digit_first =
      !part.empty() && std::isdigit(static_cast<unsigned char>(part.front())) != 0;
  return has_digit_first ? '_' + part : part;
}

}  // namespace

std::vector<std::string> topic_parts_of(const std::vector<std::string>& names) {
  // Names that need no change keep it; so that the order of the objects does not matter.
  std::set<std::pair<bool, std::string>> sorted;
  for (const std::string& name : names) sorted.emplace(name != plain_part_of(name), name);
  std::set<std::string> used{"base", "command", "tool"};
  std::map<std::string, std::string> part_of;
  for (const auto& [is_changed, name] : sorted) {
    const std::string plain = plain_part_of(name);
    std::string part = plain;
    for (int i = 2; used.contains(part) || used.contains(part + kPredictedFrame); ++i) {
      part = plain + '_' + std::to_string(i);
    }
    used.insert({part, part + kPredictedFrame});
    part_of[name] = part;
  }
  std::vector<std::string> parts;
  for (const std::string& name : names) parts.push_back(part_of.at(name));
  return parts;
}

}  // namespace pcavr
