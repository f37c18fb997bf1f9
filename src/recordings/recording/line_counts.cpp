// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/line_counts.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/time_series.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr char kWrittenFormat[] = "pcavr-written/1";
/// Far more than ten hours at 1 kHz.
constexpr int kMaxLines = 1'000'000'000;

struct Lines {
  std::size_t count = 0;
  bool is_complete = true;  ///< the last line has a line end, too
};

Lines lines_of(std::string_view text) {
  const auto ends = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  const bool is_complete = text.empty() || text.back() == '\n';
  return {ends + (is_complete ? 0 : 1), is_complete};
}

/// Counts in blocks: the files of a long run are too large to be read into memory at once.
Expected<Lines> lines_of_file(const fs::path& file) {
  const Expected<std::uintmax_t> size = regular_file_size(file);
  if (!size) return size.error();
  std::ifstream stream(file, std::ios::binary);
  Lines lines;
  std::vector<char> block(1 << 16);
  for (;;) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(stream.gcount());
    if (count == 0) break;
    const Lines more = lines_of({block.data(), count});
    // A block that ends inside a line counts that line, and so does the next.
    lines.count += more.count - (lines.is_complete ? 0 : 1);
    lines.is_complete = more.is_complete;
  }
  if (stream.bad()) return Error{.message = "could not be read to the end", .file = file.string()};
  return lines;
}

Expected<void> check_lines(const Lines& found, std::size_t lines, const fs::path& file) {
  if (found.is_complete && found.count == lines) return {};
  const std::string count = std::to_string(found.count);
  return Error{
      .message = "was truncated or changed since it was written: it " +
                 (found.is_complete ? "has " + count + " lines" : "ends inside line " + count) +
                 ", and " + std::to_string(lines) + " were written",
      .file = file.string(),
      .hint = "copy or create it again"};
}

bool is_counted(const fs::path& relative) {
  const fs::path extension = relative.extension();
  return (extension == ".txt" || extension == ".csv") && *relative.begin() != "truth";
}

LineCounts counts_of(const YamlValue& value) {
  LineCounts counts;
  for (const auto& [file, count] : value.entries()) {
    if (const auto path = path_inside_folder(file); !path) {
      count.fail(path.error().message, path.error().hint);
    }
    counts.emplace(file, static_cast<std::size_t>(count.integer(0, kMaxLines)));
  }
  return counts;
}

}  // namespace

Expected<LineCounts> count_lines(const fs::path& folder) {
  LineCounts counts;
  std::error_code code;
  for (fs::recursive_directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    const fs::path relative = entry->path().lexically_relative(folder);
    if (!entry->is_regular_file(code) || !is_counted(relative)) continue;
    const Expected<Lines> lines = lines_of_file(entry->path());
    if (!lines) return lines.error();
    counts[relative.generic_string()] = lines->count;
  }
  if (code) return Error{.message = "can't be read: " + code.message(), .file = folder.string()};
  return counts;
}

Expected<void> write_line_counts(const fs::path& folder) {
  const Expected<LineCounts> counts = count_lines(folder);
  if (!counts) return counts.error();
  YAML::Emitter out;
  out << YAML::Comment(
      "Number of lines of each file when it was written: another number is refused.\n"
      "Remove this file after an intended change.");
  out << YAML::BeginMap << YAML::Key << "format" << YAML::Value << kWrittenFormat;
  out << YAML::Key << "lines" << YAML::Value << YAML::BeginMap;
  for (const auto& [file, count] : *counts) out << YAML::Key << file << YAML::Value << count;
  out << YAML::EndMap << YAML::EndMap;
  return write_file(folder / kWrittenFile, std::string(out.c_str()) + '\n');
}

Expected<std::optional<LineCounts>> read_line_counts(const fs::path& manifest) {
  using Counts = std::optional<LineCounts>;
  const Expected<bool> has_manifest = is_present(manifest);
  if (!has_manifest) return has_manifest.error();
  if (!*has_manifest) return Counts();
  const Expected<std::string> text = read_file(manifest);
  if (!text) return text.error();
  return parse_yaml<Counts>(*text, manifest.string(), [](const YamlValue& root) {
    const std::optional<YamlValue> lines = root.find("lines");
    return lines ? Counts(counts_of(*lines)) : Counts();
  });
}

Expected<void> check_line_count(const fs::path& file, std::size_t lines) {
  const Expected<Lines> found = lines_of_file(file);
  if (!found) return found.error();
  return check_lines(*found, lines, file);
}

Expected<void> check_line_count(std::string_view text, std::size_t lines, const fs::path& file) {
  return check_lines(lines_of(text), lines, file);
}

Expected<void> check_line_counts(const fs::path& manifest) {
  const Expected<std::optional<LineCounts>> counts = read_line_counts(manifest);
  if (!counts) return counts.error();
  if (!*counts) return {};
  for (const auto& [name, lines] : **counts) {
    const fs::path file = manifest.parent_path() / name;
    const Expected<bool> exists = is_present(file);
    if (!exists) return exists.error();
    if (!*exists) continue;
    const Expected<Lines> found = lines_of_file(file);
    if (!found) return found.error();
    const Expected<void> intact = check_lines(*found, lines, file);
    if (intact) continue;
    Error error = intact.error();
    if (manifest.filename() == kWrittenFile) {
      error.hint += ", or remove " + std::string(kWrittenFile) + " if the change is intended";
    }
    return error;
  }
  return {};
}

}  // namespace pcavr
