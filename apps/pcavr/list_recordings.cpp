// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "list_recordings.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "pcavr/base/core/output.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

bool is_recording(const fs::path& folder) {
  std::error_code code;
  return fs::exists(folder / "recording.yaml", code);
}

/// The recordings directly in a folder, by name.
std::vector<std::string> recordings_in(const fs::path& folder) {
  std::vector<std::string> found;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    if (is_recording(entry->path())) found.push_back(entry->path().string());
  }
  std::ranges::sort(found);
  return found;
}

Expected<std::vector<std::string>> recordings_of_list(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  std::vector<std::string> found;
  std::istringstream lines(*text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line.empty() || line.front() == '#') continue;
    const fs::path folder = file.parent_path() / line;
    std::error_code code;
    if (!fs::is_directory(folder, code)) {
      return Error{.message = "is not a folder: " + line,
                   .file = file.string(),
                   .place = "line " + std::to_string(number),
                   .hint = "list one recording's folder in each line, relative to the list"};
    }
    found.push_back(folder.string());
  }
  if (found.empty()) {
    return Error{.message = "lists no recording",
                 .file = file.string(),
                 .place = {},
                 .hint = "list one recording's folder in each line"};
  }
  return found;
}

}  // namespace

Expected<std::vector<std::string>> list_recordings(const std::vector<std::string>& arguments) {
  std::vector<std::string> all;
  for (const std::string& argument : arguments) {
    std::error_code code;
    std::vector<std::string> found{argument};
    if (fs::is_regular_file(argument, code)) {
      Expected<std::vector<std::string>> listed = recordings_of_list(argument);
      if (!listed) return listed.error();
      found = std::move(*listed);
    } else if (!is_recording(argument)) {
      std::vector<std::string> inside = recordings_in(argument);
      if (!inside.empty()) found = std::move(inside);
    }
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

}  // namespace pcavr::app
