// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// One cloud file of a sequence.
struct ListedCloud {
  Stamp stamp;
  std::filesystem::path file;
};

struct CloudList {
  std::vector<ListedCloud> clouds;  ///< ascending stamps
  /// The stamps are times of a clock; else frame numbers, at the given rate.
  bool has_times = false;
};

/// Whether a path names clouds: a folder with .pcd or .ply files, one such file, or a list of them.
[[nodiscard]] bool has_clouds(const std::filesystem::path& source);

/// The clouds of a folder, of a list (a text file with `timestamp path` in each line, paths
/// relative to it) or a single one. In a folder the last number in a file's name is its stamp: with
/// a decimal point or ten digits in seconds, with 13, 16 or 19 digits in milli-, micro- or
/// nanoseconds, else the number of the frame, of which there are `frame_rate` in a second [Hz].
/// Equal stamps, names of different kinds and files without a number (of several) are Errors.
[[nodiscard]] Expected<CloudList> list_clouds(const std::filesystem::path& source,
                                              double frame_rate);

}  // namespace pcavr
