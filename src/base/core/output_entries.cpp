// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/output_entries.hpp"

#include <algorithm>
#include <system_error>

#include "pcavr/base/core/output.hpp"

#include "base/core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kSeparators = " \t\r:,[]{}\"'";  // of YAML's and the lists' words

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t end = text.find_last_not_of(kBlanks);
  return end == text.npos ? std::string_view() : text.substr(begin, end + 1 - begin);
}

/// Whether `name`, of a component without its `*` or `#`, may stand there.
bool may_replace(char wildcard, std::string_view name, const NamedEntries& named) {
  if (wildcard == '*') return named.contains(name);
  return !name.empty() && name.find_first_not_of("0123456789") == name.npos;
}

bool matches_component(std::string_view component, std::string_view pattern,
                       const NamedEntries& named) {
  const std::size_t wildcard = pattern.find_first_of("*#");
  if (wildcard == pattern.npos) return component == pattern;
  const std::string_view before = pattern.substr(0, wildcard);
  const std::string_view after = pattern.substr(wildcard + 1);
  if (component.size() < before.size() + after.size()) return false;
  if (!component.starts_with(before) || !component.ends_with(after)) return false;
  component.remove_prefix(before.size());
  component.remove_suffix(after.size());
  return may_replace(pattern[wildcard], component, named);
}

}  // namespace

/// The words of each line, what is in quotes, and what is before and after a colon: a name may
/// contain blanks.
void NamedEntries::add(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    for (std::size_t at = 0; at < line.size();) {
      const std::size_t next = std::min(line.find_first_of(kSeparators, at), line.size());
      if (next > at) names_.emplace(line.substr(at, next - at));
      at = next + 1;
    }
    for (std::size_t open = line.find('"'); open != line.npos;) {
      const std::size_t close = line.find('"', open + 1);
      if (close == line.npos) break;
      names_.emplace(line.substr(open + 1, close - open - 1));
      open = line.find('"', close + 1);
    }
    if (const std::size_t colon = line.find(':'); colon != line.npos) {
      names_.emplace(trimmed(line.substr(0, colon)));
      names_.emplace(trimmed(line.substr(colon + 1)));
    }
  }
}

bool matches(std::string_view path, std::string_view pattern, const NamedEntries& named) {
  while (true) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::size_t pattern_end = std::min(pattern.find('/'), pattern.size());
    if (!matches_component(path.substr(0, end), pattern.substr(0, pattern_end), named))
      return false;
    const bool is_last = end == path.size();
    if (is_last != (pattern_end == pattern.size())) return false;
    if (is_last) return true;
    path.remove_prefix(end + 1);
    pattern.remove_prefix(pattern_end + 1);
  }
}

std::optional<std::string> find_foreign_file(const fs::path& folder,
                                             const std::vector<std::string_view>& texts,
                                             const std::vector<std::string_view>& patterns) {
  NamedEntries named;
  for (const std::string_view text : texts) {
    if (const Expected<std::string> content = read_file(folder / text)) named.add(*content);
  }
  std::error_code code;
  fs::recursive_directory_iterator entry(folder, code);
  for (const fs::recursive_directory_iterator end; !code && entry != end; entry.increment(code)) {
    const fs::path path = entry->path().lexically_relative(folder);
    const bool is_folder = entry->symlink_status(code).type() == fs::file_type::directory;
    if (is_folder && PartialNames::is_inside_name(path.string())) entry.disable_recursion_pending();
    if (is_folder || entry.depth() == 0) continue;
    const std::string text = path.generic_string();
    const bool is_ours = named.contains(text) || std::any_of(patterns.begin(), patterns.end(),
                                                             [&](std::string_view pattern) {
                                                               return matches(text, pattern, named);
                                                             });
    if (!is_ours) return text;
  }
  if (code) return folder.string();
  return std::nullopt;
}

}  // namespace pcavr
