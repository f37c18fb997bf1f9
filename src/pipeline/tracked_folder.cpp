// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/replay.hpp"

namespace pcavr {
namespace {

// Where a run does not say how sure it is.
constexpr double kUnstatedPosition = 0.001;  // [m]
constexpr double kUnstatedRotation = 0.010;  // [rad]

struct Deviations {
  double position = kUnstatedPosition;
  double rotation = kUnstatedRotation;
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

/// A number >= 0; nothing for anything else.
std::optional<double> deviation_of(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  const bool is_number = !cell.empty() && *end == '\0' && std::isfinite(value) && value >= 0.0;
  return is_number ? std::optional(value) : std::nullopt;
}

/// By stamp.
Expected<std::map<Stamp, Deviations>> read_deviations(const std::filesystem::path& file) {
  std::map<Stamp, Deviations> result;
  if (!std::filesystem::exists(file)) return result;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  std::istringstream lines(*text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = cells_of(line);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  const std::size_t position = column("position_sigma");
  const std::size_t rotation = column("rotation_sigma");
  for (int number = 2; std::getline(lines, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    const Error bad{
        .message = "no tracking row: '" + line + "'",
        .file = file.string(),
        .line = number,
        .hint = "t,evidence,tags,position_sigma,rotation_sigma,... as replay writes it"};
    if (cells.size() <= std::max(position, rotation)) return bad;
    const Expected<Stamp> stamp = parse_stamp(cells.front());
    const std::optional<double> first = deviation_of(cells[position]);
    const std::optional<double> second = deviation_of(cells[rotation]);
    if (!stamp || !first || !second) return bad;
    result[*stamp] = {*first, *second};
  }
  return result;
}

}  // namespace

Expected<std::vector<TrackedPose>> read_tracked_poses(const std::filesystem::path& folder,
                                                      const std::string& name) {
  std::vector<TrackedPose> result;
  const std::filesystem::path place = folder / "objects" / name;
  if (!std::filesystem::exists(place / "tracked.txt")) return result;
  const Expected<Trajectory> poses = read_trajectory(place / "tracked.txt");
  if (!poses) return poses.error();
  const auto deviations = read_deviations(place / "tracking.csv");
  if (!deviations) return deviations.error();
  for (const TimedPose& timed : poses->poses()) {
    const auto found = deviations->find(timed.stamp);
    const Deviations deviation = found == deviations->end() ? Deviations{} : found->second;
    result.push_back({timed.stamp.seconds(), timed.pose, deviation.position, deviation.rotation});
  }
  return result;
}

}  // namespace pcavr
