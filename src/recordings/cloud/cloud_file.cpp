// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pcavr/base/core/output.hpp"

#include "recordings/cloud/parse_formats.hpp"

namespace pcavr {

std::size_t RecordedCloud::measured_points() const {
  return static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [](const Eigen::Vector3f& p) { return !std::isnan(p.x()); }));
}

std::optional<std::size_t> parse_count(std::string_view text) {
  std::int64_t number = -1;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc{} || end != text.data() + text.size() || number < 0) return std::nullopt;
  return static_cast<std::size_t>(number);
}

std::vector<std::string> split_fields(std::string_view line) {
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(" \t\r");
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(" \t\r", end);
  }
  return fields;
}

std::optional<Pose> header_pose(const Eigen::Vector3d& position,
                                const Eigen::Quaterniond& rotation) {
  constexpr double kMaxNormError = 0.1;  // as for the trajectories of a recording
  const bool is_pose = position.allFinite() && rotation.coeffs().allFinite() &&
                       std::abs(rotation.norm() - 1.0) < kMaxNormError &&
                       position.cwiseAbs().maxCoeff() < 1e9;
  if (!is_pose) return std::nullopt;
  return Pose(rotation, position);
}

Error cloud_error(const std::string& file, int line, std::string message, std::string hint) {
  return {.message = std::move(message), .file = file, .line = line, .hint = std::move(hint)};
}

Error truncated_error(const std::string& file, std::size_t points, std::size_t bytes_needed,
                      std::size_t bytes_there) {
  return {.message = "is truncated: " + std::to_string(points) + " points need " +
                     std::to_string(bytes_needed) + " bytes, " + std::to_string(bytes_there) +
                     " follow the header",
          .file = file,
          .hint = "copy or record the file again"};
}

Expected<RecordedCloud> parse_cloud(std::string_view bytes, const std::string& file) {
  if (bytes.empty()) return cloud_error(file, 0, "is empty", "copy or record the file again");
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n")) return parse_ply(bytes, file);
  if (bytes.starts_with("# .PCD") || bytes.starts_with("VERSION")) return parse_pcd(bytes, file);
  return cloud_error(file, 1, "is neither a PCD nor a PLY file",
                     "a PCD file begins with '# .PCD' or 'VERSION', a PLY file with 'ply'");
}

Expected<RecordedCloud> read_cloud(const std::filesystem::path& file) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return parse_cloud(*bytes, file.string());
}

}  // namespace pcavr
