// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "recordings/bag_import/pose_numbers.hpp"
#include "recordings/bag_import/pose_table.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxDigits = 9;  ///< of a view's number

bool is_yaml(const fs::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

/// The number that ends a file's name, before its extension.
std::optional<int> number_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
  if (begin == stem.size() || stem.size() - begin > kMaxDigits) return std::nullopt;
  return std::stoi(stem.substr(begin));
}

/// The files with a number and a text's extension, by their numbers.
Expected<std::map<int, fs::path>> numbered_files(const fs::path& folder, const std::string& start) {
  std::map<int, fs::path> files;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    const fs::path& file = entry->path();
    const std::string extension = file.extension().string();
    const bool is_text = extension == ".txt" || extension == ".csv" || is_yaml(file);
    if (!is_text || !file.filename().string().starts_with(start)) continue;
    const std::optional<int> number = number_of(file);
    if (!number) continue;
    const auto [before, is_new] = files.emplace(*number, file);
    if (is_new) continue;
    return Error{
        .message = fmt::format("two files have the number {}: {} and {}", *number,
                               before->second.filename().string(), file.filename().string()),
        .file = folder.string(),
        .hint =
            "give the folder with what the names of the poses' files begin with, such "
            "as poses/robot"};
  }
  if (files.empty()) {
    return Error{.message = "has no files of poses: none has a number and is txt, csv or yaml",
                 .file = (folder / start).string(),
                 .hint = "give a file for each view, such as pose_0.txt, or a table"};
  }
  return files;
}

/// The values of the first of these keys that the map has, itself a map, or else of the map.
std::vector<double> values_of(const YamlValue& root, std::initializer_list<const char*> maps,
                              const std::vector<std::string>& keys,
                              const std::vector<std::string>& inner_keys) {
  std::vector<double> values;
  for (const char* name : maps) {
    const std::optional<YamlValue> map = root.find(name);
    if (!map) continue;
    for (const std::string& key : inner_keys) values.push_back(map->at(key).number());
    return values;
  }
  for (const std::string& key : keys) values.push_back(root.at(key).number());
  return values;
}

Expected<std::vector<double>> yaml_numbers(const std::string& text, const std::string& file) {
  return parse_yaml<std::vector<double>>(text, file, [](const YamlValue& given) {
    const YamlValue root = given.find("pose").value_or(given);
    std::vector<double> values =
        values_of(root, {"position", "translation"}, {"x", "y", "z"}, {"x", "y", "z"});
    const std::vector<double> rotation = values_of(root, {"orientation", "rotation"},
                                                   {"qx", "qy", "qz", "qw"}, {"x", "y", "z", "w"});
    values.insert(values.end(), rotation.begin(), rotation.end());
    return values;
  });
}

/// All numbers of a text, over its lines.
Expected<std::vector<double>> text_numbers(std::string_view text, const std::string& file) {
  std::vector<double> numbers;
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::string_view row = trimmed(*line);
    if (row.empty() || row.starts_with('#')) continue;
    for (const std::string& field : split_fields(separator_of(row), row)) {
      const std::optional<double> number = parse_number(field);
      if (!number) {
        return Error{.message = "'" + field + "' is not a finite number",
                     .file = file,
                     .line = lines.line(),
                     .hint = "write the four rows of a matrix"};
      }
      numbers.push_back(*number);
    }
  }
  return numbers;
}

Expected<ListedPose> read_view(const fs::path& file, int number, const PoseListOptions& options,
                               PoseForm& form) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Expected<std::vector<double>> numbers =
      is_yaml(file) ? yaml_numbers(*text, file.string()) : text_numbers(*text, file.string());
  if (!numbers) return numbers.error();
  const std::optional<PoseForm> found = form_of_count(numbers->size());
  if (!found) {
    return Error{.message = fmt::format("has {} numbers, not those of one pose", numbers->size()),
                 .file = file.string(),
                 .hint =
                     "write the four rows of a matrix, or x y z qx qy qz qw; the file may have "
                     "been cut while it was written"};
  }
  form = *found;
  const Expected<Pose> pose = pose_of_numbers(form, *numbers, options.is_w_first && !is_yaml(file));
  if (!pose) {
    Error error = pose.error();
    error.file = file.string();
    return error;
  }
  return ListedPose{.pose = *pose, .number = number, .file = file.string()};
}

}  // namespace

Expected<PosesInFileUnit> read_pose_folder(const fs::path& folder, const std::string& start,
                                           const PoseListOptions& options) {
  const Expected<std::map<int, fs::path>> files = numbered_files(folder, start);
  if (!files) return files.error();
  PosesInFileUnit found;
  PoseForm form = PoseForm::matrix;
  std::size_t skipped = 0;
  for (const auto& [number, file] : *files) {
    Expected<ListedPose> view = read_view(file, number, options, form);
    if (view) {
      found.list.poses.push_back(*std::move(view));
    } else if (options.skip_bad) {
      if (skipped++ == 0) found.list.notes.push_back("left out: " + view.error().to_string());
    } else {
      return view.error();
    }
  }
  if (skipped > 1) found.list.notes.push_back(fmt::format("{} files are left out", skipped));
  found.list.format = fmt::format("{} files, {}", found.list.poses.size(), name_of(form));
  return found;
}

}  // namespace pcavr
