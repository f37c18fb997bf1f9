// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_list.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

bool is_cloud_file(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".pcd" || extension == ".ply";
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Meaning of the number in a file's name.
enum class NameKind { none, frame, time };

struct NameStamp {
  NameKind kind = NameKind::none;
  Stamp stamp;
};

/// The last number of a name: digits, with one decimal point inside them.
std::string_view last_number(std::string_view name) {
  std::size_t end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  std::size_t whole = begin;
  if (begin > 1 && name[begin - 1] == '.' && is_digit(name[begin - 2])) {
    whole = begin - 1;
    while (whole > 0 && is_digit(name[whole - 1])) --whole;
  }
  return name.substr(whole, end - whole);
}

/// The stamp of a number of digits, in units of 10^-`decimals` seconds.
std::optional<Stamp> scaled_stamp(std::string_view digits, std::size_t decimals) {
  const std::string seconds = std::string(digits.substr(0, digits.size() - decimals)) + '.' +
                              std::string(digits.substr(digits.size() - decimals));
  const Expected<Stamp> stamp = parse_stamp(seconds);
  if (!stamp) return std::nullopt;
  return *stamp;
}

Expected<NameStamp> stamp_of_name(const fs::path& file, double frame_rate) {
  const std::string stem = file.stem().string();
  const std::string_view number = last_number(stem);
  if (number.empty()) return NameStamp{};
  const Error no_stamp{.message = "the name has no stamp in range",
                       .file = file.string(),
                       .hint = "name it by seconds or a frame number, or give a list"};
  if (number.find('.') != number.npos) {
    const Expected<Stamp> stamp = parse_stamp(number);
    if (!stamp) return no_stamp;
    return NameStamp{NameKind::time, *stamp};
  }
  for (const std::size_t decimals : {0U, 3U, 6U, 9U}) {
    if (number.size() != 10 + decimals) continue;
    const std::optional<Stamp> stamp = decimals == 0 ? [&]() -> std::optional<Stamp> {
      const Expected<Stamp> whole = parse_stamp(number);
      if (!whole) return std::nullopt;
      return *whole;
    }()
        : scaled_stamp(number, decimals);
    if (!stamp) return no_stamp;
    return NameStamp{NameKind::time, *stamp};
  }
  const std::optional<double> frame = parse_number(number);
  if (!frame || !ranges::kStamp.contains(*frame / frame_rate)) return no_stamp;
  return NameStamp{NameKind::frame, Stamp::from_seconds(*frame / frame_rate)};
}

Expected<CloudList> list_folder(const fs::path& folder, double frame_rate) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    if (is_cloud_file(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  CloudList list;
  std::optional<NameKind> kind;
  for (const fs::path& file : files) {
    const Expected<NameStamp> name = stamp_of_name(file, frame_rate);
    if (!name) return name.error();
    if (name->kind == NameKind::none && files.size() > 1) {
      return Error{.message = "the name has no number for its stamp",
                   .file = file.string(),
                   .hint = "name the files by seconds or frame numbers, or give a list"};
    }
    if (kind && *kind != name->kind) {
      return Error{.message = "is named by a frame number, others by their time, or vice versa",
                   .file = file.string(),
                   .hint = "name all files alike, or give a list"};
    }
    kind = name->kind;
    list.clouds.push_back({name->stamp, file});
  }
  list.has_times = kind == NameKind::time;
  return list;
}

Expected<CloudList> read_list(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Expected<Series<std::vector<ListedImage>>> listed =
      parse_image_list({file.string(), *text});
  if (!listed) return listed.error();
  CloudList list{.clouds = {}, .has_times = true};
  for (const ListedImage& cloud : listed->content) {
    std::error_code code;
    if (!fs::is_regular_file(file.parent_path() / cloud.path, code)) {
      return Error{.message = "the cloud " + cloud.path.string() + ' ' +
                              fault_of_listed(file.parent_path() / cloud.path),
                   .file = file.string(),
                   .line = cloud.line,
                   .hint = "add the file, or remove the line"};
    }
    list.clouds.push_back({cloud.stamp, file.parent_path() / cloud.path});
  }
  return list;
}

}  // namespace

bool has_clouds(const fs::path& source) {
  std::error_code code;
  if (fs::is_regular_file(source, code)) {
    return is_cloud_file(source) || source.extension() == ".txt";
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(source, code)) {
    if (is_cloud_file(entry.path())) return true;
  }
  return false;
}

Expected<CloudList> list_clouds(const fs::path& source, double frame_rate) {
  std::error_code code;
  CloudList list;
  if (fs::is_directory(source, code)) {
    Expected<CloudList> found = list_folder(source, frame_rate);
    if (!found) return found.error();
    list = *std::move(found);
  } else if (is_cloud_file(source)) {
    list.clouds.push_back({Stamp{}, source});
  } else {
    Expected<CloudList> read = read_list(source);
    if (!read) return read.error();
    list = *std::move(read);
  }
  if (list.clouds.empty()) {
    return Error{.message = "names no clouds",
                 .file = source.string(),
                 .hint = "give a folder with .pcd or .ply files, or a list 'timestamp path'"};
  }
  std::stable_sort(list.clouds.begin(), list.clouds.end(),
                   [](const ListedCloud& a, const ListedCloud& b) { return a.stamp < b.stamp; });
  for (std::size_t i = 1; i < list.clouds.size(); ++i) {
    if (list.clouds[i - 1].stamp < list.clouds[i].stamp) continue;
    return Error{.message = "has the stamp of " + list.clouds[i - 1].file.filename().string(),
                 .file = list.clouds[i].file.string(),
                 .hint = "one cloud at a time: give each its own stamp"};
  }
  return list;
}

}  // namespace pcavr
