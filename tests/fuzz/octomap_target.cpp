// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "pcavr/base/core/check.hpp"
#include "pcavr/perception/scene/occupancy_tree.hpp"
#include "pcavr/perception/scene/octomap_file.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void octomap(std::string_view bytes) {
  const Expected<OccupancyTree> tree = OccupancyTree::parse(bytes, "the-file");
  // The other reader of binary trees accepts the same bytes.
  const Expected<OctomapContent> content = parse_octomap(bytes, "the-file");
  if (!tree) {
    const Error& error = tree.error();
    PCAVR_REQUIRE(error.file == "the-file" && !error.message.empty(), error.to_string());
    PCAVR_REQUIRE(!content.has_value());
    return;
  }
  PCAVR_REQUIRE(tree->resolution() > 0.0, tree->resolution());
  int checked = 0;
  bool has_occupied = false;
  tree->for_each_occupied([&](const Eigen::Vector3d& centre, double edge) {
    has_occupied = true;
    PCAVR_REQUIRE(edge >= tree->resolution() * 0.999, edge);
    // Near the border of OctoMap's keys a search fails by rounding.
    constexpr double kMaxCell = 32000.0;
    if (checked == 16 || centre.cwiseAbs().maxCoeff() + edge > kMaxCell * tree->resolution())
      return;
    ++checked;
    PCAVR_REQUIRE(tree->is_occupied(centre));
    PCAVR_REQUIRE(tree->clearance(centre, tree->resolution()).value_or(1.0) == 0.0);
  });
  if (content) PCAVR_REQUIRE(has_occupied == (content->occupied > 0));
}

}  // namespace pcavr::fuzz
