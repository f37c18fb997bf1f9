// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "pcavr/core/expected.hpp"
#include "pcavr/rosbag/bag_reader.hpp"

namespace pcavr {

/// Whether `path` denotes time series in CSV files of which one at least has poses or wrenches: a
/// folder of them, or what their names begin with ("runs/push_1" for runs/push_1_tip.csv and
/// runs/push_1_force.csv, but not runs/push_10_tip.csv). A recording's folder does not.
[[nodiscard]] bool has_csv_series(const std::filesystem::path& path);

/// Reads such files as a bag: each is a topic, named by the rest of its name ("tip", "force").
/// Columns by the header, in any order, others are ignored:
///  - the sensor's stamp: t_header, timestamp, time or t; the recorder's: t_bag or t_receive [s];
///  - a pose: x, y, z [m], qx, qy, qz, qw; a point: x, y, z alone;
///  - a wrench: fx, fy, fz [N], tx, ty, tz [N m].
/// A file without these is a topic of type "csv". Errors name file and line.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_csv_series(
    const std::filesystem::path& path);

/// open_csv_series where has_csv_series, else open_bag.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_bag_or_csv(
    const std::filesystem::path& path);

}  // namespace pcavr
