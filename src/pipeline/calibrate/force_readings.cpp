// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/pipeline/calibrate_force.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {
namespace {

/// [s] Rows that follow each other faster are a log, not poses that were chosen.
constexpr double kMaxLogInterval = 0.5;
constexpr double kMinRest = 0.3;  ///< [s] shorter rests still swing
/// A flange that turns and moves by less is at rest [rad, m].
constexpr double kMaxRestTurn = 0.5 * std::numbers::pi / 180.0;
constexpr double kMaxRestShift = 1e-3;
constexpr std::size_t kMinRests = 6;
constexpr std::size_t kMaxLogRows = 300;  ///< of a log without rests

struct ForceRow {
  std::optional<Stamp> stamp = {};
  int line = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> torque = {};
};

struct NumberColumn {
  std::size_t column = 0;
  double factor = 1.0;
};

/// [N] or [N m] of a unit; nothing where it is not known.
std::optional<double> unit_factor(const std::string& unit) {
  const std::map<std::string, double> factors = {{"", 1.0},   {"n", 1.0},    {"kn", 1e3},
                                                 {"nm", 1.0}, {"ncm", 1e-2}, {"nmm", 1e-3}};
  const auto found = factors.find(unit);
  if (found == factors.end()) return std::nullopt;
  return found->second;
}

/// The three columns of a force or torque, by the words that their names begin with.
std::optional<std::array<NumberColumn, 3>> vector_columns(const std::vector<std::string>& header,
                                                          const std::vector<std::string>& words) {
  std::array<NumberColumn, 3> columns;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<std::string> names = words;
    for (std::string& name : names) name += "xyz"[axis];
    const std::optional<FoundColumn> found = find_column(header, names);
    if (!found) return std::nullopt;
    const std::optional<double> factor = unit_factor(found->unit);
    if (!factor) return std::nullopt;
    columns[axis] = {found->column, *factor};
  }
  return columns;
}

/// Whether tx, ty, tz are where the flange is, as in a list of TUM's: a rotation, and no x, y, z.
bool is_position(const std::vector<std::string>& header, const std::string& word) {
  const auto has = [&](const std::string& name) { return find_column(header, {name}).has_value(); };
  return has(word + 'x') && (has("qx") || has("rx")) && !has("x");
}

struct StampColumn {
  std::size_t column = 0;
  std::optional<TimeUnit> unit = {};  ///< of the header
};

std::optional<StampColumn> stamp_column(const std::vector<std::string>& header) {
  const std::optional<FoundColumn> found = find_column(header, {"t", "time", "timestamp"});
  if (!found) return std::nullopt;
  return StampColumn{found->column, parse_time_unit(found->unit)};
}

/// Without a unit in the header, in that in which the number is a time.
std::optional<Stamp> stamp_of(const std::string& field, const StampColumn& column) {
  const std::optional<double> number = parse_number(field);
  if (!number) return std::nullopt;
  const std::optional<TimeUnit> unit = column.unit ? column.unit : unit_of_stamp(*number);
  if (!unit) return std::nullopt;
  const Expected<Stamp> stamp = parse_stamp(field, *unit);
  return stamp ? std::optional(*stamp) : std::nullopt;
}

std::optional<Eigen::Vector3d> vector_of(const std::vector<std::string>& fields,
                                         const std::array<NumberColumn, 3>& columns) {
  Eigen::Vector3d vector;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns[axis].column >= fields.size()) return std::nullopt;
    const std::optional<double> number = parse_number(fields[columns[axis].column]);
    if (!number) return std::nullopt;
    vector[static_cast<Eigen::Index>(axis)] = columns[axis].factor * *number;
  }
  return vector;
}

struct ForceTable {
  std::vector<ForceRow> rows = {};
  bool has_torque = false;
};

Expected<ForceTable> read_force_table(const std::filesystem::path& file, bool skip_bad) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  LineReader lines(*text);
  const std::string header(lines.next().value_or(""));
  const char separator = separator_of(header);
  const std::vector<std::string> names = split_fields(separator, header);
  const auto force = vector_columns(names, {"f", "f_", "force", "force_"});
  std::vector<std::string> torque_words{"m", "m_", "tau", "tau_", "torque", "torque_"};
  if (!is_position(names, "t")) torque_words.insert(torque_words.end(), {"t", "t_"});
  const auto torque = vector_columns(names, torque_words);
  if (!force) {
    return Error{.message = "has no columns of a force, in N",
                 .file = file.string(),
                 .line = 1,
                 .hint = "name them fx, fy, fz, and tx, ty, tz where there are torques"};
  }
  const std::optional<StampColumn> stamp = stamp_column(names);
  ForceTable table{.has_torque = torque.has_value()};
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    const std::vector<std::string> fields = split_fields(separator, *line);
    const std::optional<Eigen::Vector3d> value = vector_of(fields, *force);
    if (!value && skip_bad) continue;
    if (!value) {
      return Error{.message = "has no force in this row",
                   .file = file.string(),
                   .line = lines.line(),
                   .hint = "--skip-bad leaves such rows out"};
    }
    ForceRow row{.line = lines.line(), .force = *value};
    if (torque) row.torque = vector_of(fields, *torque);
    if (stamp && stamp->column < fields.size()) row.stamp = stamp_of(fields[stamp->column], *stamp);
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// A row with its pose.
struct PosedForce {
  Pose T_base_flange;
  ForceRow row;
};

ForceReading reading_of(const PosedForce& posed, std::size_t number) {
  return {fmt::format("pose {}", number), posed.T_base_flange.rotation(), posed.row.force,
          posed.row.torque};
}

std::vector<PosedForce> joined_by_line(const PoseList& poses, const ForceTable& forces) {
  std::map<int, const ForceRow*> by_line;
  for (const ForceRow& row : forces.rows) by_line[row.line] = &row;
  std::vector<PosedForce> joined;
  for (const ListedPose& pose : poses.poses) {
    const auto found = by_line.find(pose.line);
    if (found == by_line.end()) continue;
    joined.push_back({pose.pose, *found->second});
    joined.back().row.stamp = pose.stamp;
  }
  return joined;
}

Expected<std::vector<PosedForce>> joined_by_stamp(const PoseList& poses, const ForceTable& forces,
                                                  const std::filesystem::path& file) {
  std::vector<TimedPose> timed;
  for (const ListedPose& pose : poses.poses) {
    if (pose.stamp && (timed.empty() || timed.back().stamp < *pose.stamp)) {
      timed.push_back({*pose.stamp, pose.pose});
    }
  }
  const Trajectory trajectory(std::move(timed));
  std::vector<PosedForce> joined;
  for (const ForceRow& row : forces.rows) {
    if (!row.stamp) continue;
    const std::optional<Pose> pose = trajectory.at(*row.stamp);
    if (pose) joined.push_back({*pose, row});
  }
  if (!joined.empty()) return joined;
  return Error{.message = "no force has a pose at its time",
               .file = file.string(),
               .hint = "give both stamps of one clock, in seconds"};
}

bool is_log(const std::vector<PosedForce>& rows) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!rows[i].row.stamp || !rows[i - 1].row.stamp) return false;
    intervals.push_back(to_seconds(*rows[i].row.stamp - *rows[i - 1].row.stamp));
  }
  return !intervals.empty() && median(std::move(intervals)) < kMaxLogInterval;
}

/// The mean over rows from `first` up to `last`, at the pose in their middle.
PosedForce mean_of(const std::vector<PosedForce>& rows, std::size_t first, std::size_t last) {
  PosedForce mean = rows[first + (last - first) / 2];
  const double n = static_cast<double>(last - first);
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < last; ++i) {
    force += rows[i].row.force / n;
    if (rows[i].row.torque) torque += *rows[i].row.torque / n;
  }
  mean.row.force = force;
  if (mean.row.torque) mean.row.torque = torque;
  return mean;
}

std::vector<PosedForce> rests_of(const std::vector<PosedForce>& rows) {
  std::vector<PosedForce> rests;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t last = first + 1;
    while (last < rows.size() &&
           rotation_distance(rows[first].T_base_flange, rows[last].T_base_flange) < kMaxRestTurn &&
           translation_distance(rows[first].T_base_flange, rows[last].T_base_flange) <
               kMaxRestShift) {
      ++last;
    }
    if (to_seconds(*rows[last - 1].row.stamp - *rows[first].row.stamp) >= kMinRest) {
      rests.push_back(mean_of(rows, first, last));
      first = last;
    } else {
      ++first;
    }
  }
  return rests;
}

std::vector<PosedForce> thinned(const std::vector<PosedForce>& rows) {
  std::vector<PosedForce> some;
  const std::size_t n = std::min(rows.size(), kMaxLogRows);
  for (std::size_t i = 0; i < n; ++i) some.push_back(rows[i * rows.size() / n]);
  return some;
}

}  // namespace

Expected<ForceReadings> read_force_readings(const ForceInput& input) {
  const Expected<PoseList> poses = read_pose_list(input.poses, input.reading);
  if (!poses) return poses.error();
  const std::filesystem::path& file = input.forces.empty() ? input.poses : input.forces;
  const Expected<ForceTable> forces = read_force_table(file, input.reading.skip_bad);
  if (!forces) return forces.error();
  Expected<std::vector<PosedForce>> joined = input.forces.empty()
                                                 ? joined_by_line(*poses, *forces)
                                                 : joined_by_stamp(*poses, *forces, input.forces);
  if (!joined) return joined.error();
  ForceReadings found{.notes = poses->notes};
  found.format = fmt::format("{}, {} forces{}", poses->format, forces->rows.size(),
                             forces->has_torque ? " and torques" : "");
  if (is_log(*joined)) {
    std::vector<PosedForce> rests = rests_of(*joined);
    if (rests.size() >= kMinRests) {
      found.format += fmt::format(", {} rests", rests.size());
      joined = std::move(rests);
    } else {
      found.notes.push_back(fmt::format(
          "the flange rests {} times only: rows in motion are used, too, whose accelerations are "
          "part of the residual",
          rests.size()));
      joined = thinned(*joined);
    }
  }
  for (const PosedForce& posed : *joined) {
    found.readings.push_back(reading_of(posed, found.readings.size() + 1));
  }
  return found;
}

}  // namespace pcavr
