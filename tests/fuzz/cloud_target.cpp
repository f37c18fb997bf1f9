// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void cloud(std::string_view bytes) {
  const Expected<RecordedCloud> cloud = parse_cloud(bytes, "the-file");
  if (!cloud) {
    const Error& error = cloud.error();
    PCAVR_REQUIRE(error.file == "the-file" && !error.message.empty() && !error.hint.empty(),
                  error.to_string());
    return;
  }
  const std::size_t count = cloud->points.size();
  PCAVR_REQUIRE(static_cast<std::size_t>(cloud->width) * static_cast<std::size_t>(cloud->height) ==
                count);
  PCAVR_REQUIRE(cloud->colors.empty() || cloud->colors.size() == count);
  PCAVR_REQUIRE(cloud->normals.empty() || cloud->normals.size() == count);
  for (const Eigen::Vector3f& p : cloud->points) {
    PCAVR_REQUIRE(p.allFinite() || p.array().isNaN().all());
  }
  const std::size_t width = cloud->is_organised() ? static_cast<std::size_t>(cloud->width) : 0;
  const std::string written =
      format_pcd({cloud->points, cloud->normals, cloud->colors}, width, cloud->T_cloud_sensor);
  const Expected<RecordedCloud> reparsed = parse_cloud(written, "the-file");
  PCAVR_REQUIRE(reparsed.has_value(), reparsed.error().to_string());
  PCAVR_REQUIRE(reparsed->width == cloud->width || count == 0);
  PCAVR_REQUIRE(reparsed->colors == cloud->colors);
  PCAVR_REQUIRE(reparsed->measured_points() == cloud->measured_points());
}

}  // namespace pcavr::fuzz
