// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/ply_data.hpp"

#include <string_view>

#include "pcavr/core/output.hpp"

#include "model/file_start.hpp"

namespace pcavr::model {
namespace {

/// Where the data of a binary PLY begin. Only a floating-point number may be changed there.
std::optional<std::size_t> begin_of_floats(std::string_view start) {
  constexpr std::string_view kEnd = "end_header";
  const std::size_t end = start.find(kEnd);
  if (end == start.npos || !start.starts_with("ply")) return std::nullopt;
  const std::string_view header = start.substr(0, end);
  const std::size_t property = header.find("property ");
  if (header.find("format binary") == header.npos || property == header.npos) return std::nullopt;
  const std::string_view type = header.substr(property + std::string_view("property ").size());
  if (!type.starts_with("float") && !type.starts_with("double")) return std::nullopt;
  const std::size_t line_end = start.find('\n', end);
  if (line_end == start.npos || line_end + 1 >= start.size()) return std::nullopt;
  return line_end + 1;
}

}  // namespace

std::optional<std::string> ply_with_unambiguous_data(const std::filesystem::path& file) {
  const std::string start = read_file_start(file).text;
  const std::optional<std::size_t> at = begin_of_floats(start);
  if (!at || (start[*at] != '\n' && start[*at] != '\r')) return std::nullopt;
  Expected<std::string> text = read_file(file);
  if (!text || text->size() <= *at) return std::nullopt;
  char& first = (*text)[*at];
  first = static_cast<char>(first ^ 1);
  return *std::move(text);
}

}  // namespace pcavr::model
