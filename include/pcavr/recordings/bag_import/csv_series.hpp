// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

namespace pcavr {

/// How files that programs wrote as tables are read.
struct CsvOptions {
  bool skip_bad = false;  ///< leave out rows that can't be read, and count them
  /// The column that stands for a standard name: {"fx", "Fz"}, {"t", "time_ms"}.
  std::map<std::string, std::string> columns = {};
  /// Units of columns, by their standard or their own names: {"fx", "kn"}.
  std::map<std::string, std::string> units = {};
  std::optional<char> up = {};  ///< 'y' or 'z': the upward axis of a take; empty: y, as Motive has

  friend bool operator==(const CsvOptions&, const CsvOptions&) = default;
};

/// Whether `path` denotes time series in CSV files of which one at least has poses or wrenches: a
/// folder of them, or what their names begin with ("runs/push_1" for runs/push_1_tip.csv and
/// runs/push_1_force.csv, but not runs/push_10_tip.csv). A recording's folder does not.
[[nodiscard]] bool has_csv_series(const std::filesystem::path& path,
                                  const CsvOptions& options = {});

/// Reads such files as a bag: each is a topic, named by the rest of its name ("tip", "force").
/// Separated by commas, semicolons, tabs or spaces; with quotes, and decimal commas. Columns by the
/// header, in any order and case, others are ignored:
///  - the sensor's stamp: t_header, timestamp, time or t; the recorder's: t_bag or t_receive;
///  - a pose: x, y, z, qx, qy, qz, qw; a point: x, y, z alone;
///  - a wrench: fx, fy, fz, tx, ty, tz; or forces alone, with torques of 0;
///  - poses and wrenches of UR's (actual_TCP_pose_0), Franka's (O_T_EE_0) and KUKA's (x, y, z, a,
///  b,
///    c) controllers;
/// or longer names of these (pos_x, force_x), with a unit as in "Fx [N]" or "time_ms": s, ms, us,
/// ns; m, cm, mm; N, kN; Nm, Ncm, Nmm; deg, rad. Without one they are s, m, N and N m; stamps since
/// 1970 may be in any of these units, which a warning then names, or dates. A file with several of
/// these is a topic for each ("robot", "robot/force"), as is one whose columns are named after
/// bodies ("box_x"). A take of Motive is a topic for each rigid body, named after it. Stamps in
/// local time are taken as that zone in which they are nearest to the other files'. A file without
/// these columns is a topic of type "csv". Errors name file and line; with `skip_bad` rows that
/// can't be read are left out, and counted in a warning.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_csv_series(
    const std::filesystem::path& path, const CsvOptions& options = {});

/// What lies beside the CSV files of a folder and is not read by open_csv_series: names, sorted;
/// those of folders end with '/'. Empty where `path` is no folder.
[[nodiscard]] std::vector<std::string> other_files(const std::filesystem::path& path);

/// Names the columns where `path` denotes CSV files of which none has poses or wrenches.
[[nodiscard]] std::optional<Error> unknown_csv_columns(const std::filesystem::path& path);

/// open_csv_series where has_csv_series, else open_bag.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_bag_or_csv(
    const std::filesystem::path& path, const CsvOptions& options = {});

}  // namespace pcavr
