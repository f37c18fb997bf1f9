// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {

/// The text of one file of a recording, and whether to skip its bad rows.
struct SeriesText {
  std::string file;  ///< named in errors
  std::string_view text;
  bool skip_bad = false;
};

template <typename Content>
struct Series {
  Content content;
  RowReport report = {};
};

/// A line of `rgb.txt` or `depth.txt`.
struct ListedImage {
  Stamp stamp;
  std::filesystem::path path;  ///< relative to the folder, normalised
  int line = 0;
};

/// Normalises a path from a list or the manifest. Fails where it leaves the folder (path
/// traversal).
[[nodiscard]] Expected<std::filesystem::path> path_inside_folder(std::string_view text);

/// An Error, without file and line, unless the four numbers x y z w are a unit quaternion.
[[nodiscard]] std::optional<Error> check_unit_quaternion(std::span<const double> xyzw);

/// Paths are checked to stay inside the folder, not to exist.
[[nodiscard]] Expected<Series<std::vector<ListedImage>>> parse_image_list(const SeriesText& text);
[[nodiscard]] Expected<Series<Trajectory>> parse_trajectory(const SeriesText& text);
[[nodiscard]] Expected<Series<Trajectory>> parse_tool(const SeriesText& text);
[[nodiscard]] Expected<Series<std::vector<WrenchSample>>> parse_wrench(const SeriesText& text);
[[nodiscard]] Expected<Series<std::vector<JointSample>>> parse_joints(const SeriesText& text);

}  // namespace pcavr
