// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/pose_outliers.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/held_samples.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

namespace pcavr {
namespace {

// Stds for a run that has none.
constexpr double kDefaultPositionStd = 0.001;  // [m]
constexpr double kDefaultRotationStd = 0.010;  // [rad]

struct PoseStd {
  double position = kDefaultPositionStd;
  double rotation = kDefaultRotationStd;
};

/// Removes and returns the next part of `text`, up to the separator.
std::string_view take_part(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == text.npos ? text.size() : end + 1);
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> cells;
  while (!line.empty()) cells.push_back(take_part(line, ','));
  return cells;
}

/// A number in the range; nothing for anything else.
std::optional<double> parse_std(std::string_view cell, const InputRange& range) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool is_number = code == std::errc{} && end == cell.data() + cell.size();
  return is_number && range.contains(value) ? std::optional(value) : std::nullopt;
}

/// Whether a cell is a number without a value: no column has one, whatever it means.
bool is_no_value(std::string_view cell) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return code == std::errc{} && end == cell.data() + cell.size() && !std::isfinite(value);
}

/// The first column of one of these names; past the end where there is none.
std::size_t column_of(const std::vector<std::string_view>& header,
                      std::initializer_list<std::string_view> names) {
  const auto found = std::find_first_of(header.begin(), header.end(), names.begin(), names.end());
  return static_cast<std::size_t>(found - header.begin());
}

/// Reads a text file of the folder; an Error where it is truncated against the line counts of the
/// folder's run.yaml. Nothing where there is no such file.
Expected<std::optional<std::string>> read_if_present(const std::filesystem::path& folder,
                                                     const std::string& name) {
  using Text = std::optional<std::string>;
  const Expected<bool> is_there = is_present(folder / name);
  if (!is_there) return is_there.error();
  if (!*is_there) return Text();
  const auto counts = read_line_counts(folder / "run.yaml");
  if (!counts) return counts.error();
  if (*counts) {
    const auto lines = (*counts)->find(name);
    if (lines != (*counts)->end()) {
      const Expected<void> whole = check_line_count(folder / name, lines->second);
      if (!whole) return whole.error();
    }
  }
  Expected<std::string> text = read_file(folder / name);
  if (!text) return text.error();
  return Text(*std::move(text));
}

/// The stds by stamp.
Expected<std::map<Stamp, PoseStd>> parse_stds(std::string_view text,
                                              const std::filesystem::path& file) {
  std::map<Stamp, PoseStd> result;
  const std::vector<std::string_view> header = cells_of(take_part(text, '\n'));
  const std::size_t position = column_of(header, {"position_std", "position_sigma"});
  const std::size_t rotation = column_of(header, {"rotation_std", "rotation_sigma"});
  for (int number = 2; !text.empty(); ++number) {
    const std::string_view line = take_part(text, '\n');
    if (line.empty()) continue;
    const std::vector<std::string_view> cells = cells_of(line);
    const Error bad{.message = "is not a tracking row: '" + std::string(line) + "'",
                    .file = file.string(),
                    .line = number,
                    .hint = "write t,position_std,rotation_std under these names, in m and rad"};
    if (cells.size() <= std::max(position, rotation)) return bad;
    const Expected<Stamp> stamp = parse_stamp(cells.front());
    const auto first = parse_std(cells[position], ranges::kPositionStd);
    const auto second = parse_std(cells[rotation], ranges::kRotationStd);
    if (!stamp || !first || !second || std::ranges::any_of(cells, is_no_value)) return bad;
    result[*stamp] = {*first, *second};
  }
  return result;
}

/// 1-based line of the row with this stamp.
int line_of(std::string_view text, Stamp stamp) {
  for (int number = 1; !text.empty(); ++number) {
    std::string_view line = take_part(text, '\n');
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const Expected<Stamp> found = parse_stamp(line.substr(0, line.find_first_of(" \t")));
    if (found && *found == stamp) return number;
  }
  return 0;
}

/// Far from the start of a recording, a double has no room for the time between two rows.
std::optional<Error> check_resolution(const std::filesystem::path& file, std::string_view text,
                                      const std::vector<TimedPose>& poses, Stamp zero) {
  const auto rounded = [zero](const TimedPose& pose) {
    return Stamp::from_seconds(to_seconds(pose.stamp - zero));
  };
  const auto found = std::adjacent_find(
      poses.begin(), poses.end(),
      [&](const TimedPose& a, const TimedPose& b) { return rounded(a) >= rounded(b); });
  if (found == poses.end()) return std::nullopt;
  const Stamp stamp = (found + 1)->stamp;
  return Error{
      .message = "the stamp " + format_stamp(stamp, 9) +
                 " can't be distinguished from the one before: the recording's start, at " +
                 format_stamp(zero) + " s, is too far away",
      .file = file.string(),
      .line = line_of(text, stamp),
      .hint = "put both on one clock"};
}

}  // namespace

std::optional<std::filesystem::path> tracked_folder_of(
    const Recording& recording, const std::optional<std::filesystem::path>& given) {
  if (given) return given;
  std::error_code code;
  std::filesystem::path own = recording.folder / "tracked";
  if (std::filesystem::is_directory(own / "objects", code)) return own;
  return std::nullopt;
}

Pose tracked_to_object(const Recording& recording, const std::filesystem::path& folder,
                       const std::string& name) {
  if (tracked_folder_of(recording, std::nullopt) != folder) return {};
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (object.name == name) return object.T_tracked_object;
  }
  return {};
}

Expected<TrackedFile> read_tracked_poses(const std::filesystem::path& folder,
                                         const std::string& name,
                                         const TrackedFileOptions& options) {
  TrackedFile result;
  const std::string pose_file = "objects/" + name + "/tracked.txt";
  const std::string std_file = "objects/" + name + "/tracking.csv";
  const auto tracked = read_if_present(folder, pose_file);
  if (!tracked) return tracked.error();
  if (!*tracked) return result;
  auto series = parse_trajectory({(folder / pose_file).string(), **tracked, options.skip_bad});
  if (!series) return series.error();
  for (const auto& [reason, count] : series->report.left_out) {
    result.left_out.push_back({(folder / pose_file).string(), reason, count});
  }
  if (auto error =
          check_resolution(folder / pose_file, **tracked, series->content.poses(), options.zero)) {
    return *std::move(error);
  }
  const auto text = read_if_present(folder, std_file);
  if (!text) return text.error();
  const auto stds = parse_stds(text->value_or(""), folder / std_file);
  if (!stds) return stds.error();
  result.note = leave_out_held((folder / pose_file).string(), series->content);
  for (const TimedPose& timed : series->content.poses()) {
    const auto found = stds->find(timed.stamp);
    const PoseStd std_of_pose = found == stds->end() ? PoseStd{} : found->second;
    result.poses.push_back({to_seconds(timed.stamp - options.zero),
                            timed.pose * options.T_tracked_object, std_of_pose.position,
                            std_of_pose.rotation});
  }
  const PoseOutliers outliers = remove_pose_outliers(result.poses);
  if (outliers.count > 0) {
    result.left_out.push_back({(folder / pose_file).string(), describe(outliers), outliers.count});
  }
  return result;
}

std::vector<TrackedPose> tracked_poses_of(std::span<const ObjectObservation> observations,
                                          Stamp zero) {
  std::vector<TrackedPose> poses;
  for (const ObjectObservation& seen : observations) {
    if (seen.evidence == ObjectEvidence::none) continue;
    poses.push_back({to_seconds(seen.stamp - zero), seen.T_base_object,
                     std::sqrt(seen.covariance.topLeftCorner<3, 3>().trace()),
                     std::sqrt(seen.covariance.bottomRightCorner<3, 3>().trace())});
  }
  static_cast<void>(remove_pose_outliers(poses));
  return poses;
}

}  // namespace pcavr
