// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <octomap/OcTree.h>

#include "pcavr/perception/scene/occupancy_map.hpp"

namespace pcavr {

/// An empty OctoMap with the same cells and the same sensor model.
inline octomap::OcTree octomap_with(const OccupancyOptions& options) {
  octomap::OcTree tree(options.resolution);
  tree.setProbHit(options.prob_hit);
  tree.setProbMiss(options.prob_miss);
  tree.setClampingThresMin(options.clamping_min);
  tree.setClampingThresMax(options.clamping_max);
  return tree;
}

inline octomap::Pointcloud cloud_base_of(const DepthImage& depth, const CameraModel& camera,
                                         const Pose& T_base_camera) {
  octomap::Pointcloud cloud;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) <= 0.0F) continue;
      const Eigen::Vector3f p =
          (T_base_camera * camera.unproject({double(u), double(v)}, depth(u, v))).cast<float>();
      cloud.push_back(p.x(), p.y(), p.z());
    }
  }
  return cloud;
}

/// Inserts a frame with OctoMap's own implementation.
inline void insert(const octomap::Pointcloud& cloud_base, const Pose& T_base_camera,
                   const OccupancyOptions& options, octomap::OcTree& tree) {
  const Eigen::Vector3f origin = T_base_camera.translation().cast<float>();
  tree.insertPointCloud(cloud_base, {origin.x(), origin.y(), origin.z()}, options.max_range, false,
                        true);
}

struct CellAgreement {
  std::size_t known = 0;  ///< cells that are known in either map
  std::size_t same = 0;   ///< of these, free in both or occupied in both
  [[nodiscard]] double share() const {
    return known == 0 ? 1.0 : static_cast<double>(same) / static_cast<double>(known);
  }
};

inline CellAgreement compare(const OccupancyMap& map, octomap::OcTree& tree) {
  tree.expand();
  CellAgreement agreement;
  std::size_t known_to_tree = 0;
  std::size_t known_to_both = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    ++known_to_tree;
    const octomap::point3d middle = leaf.getCoordinate();
    const auto cell = map.at({middle.x(), middle.y(), middle.z()});
    if (cell == OccupancyMap::Cell::unknown) continue;
    ++known_to_both;
    if ((cell == OccupancyMap::Cell::occupied) == tree.isNodeOccupied(*leaf)) ++agreement.same;
  }
  const OccupancyMap::Counts counts = map.counts();
  agreement.known = known_to_tree + counts.free + counts.occupied - known_to_both;
  return agreement;
}

}  // namespace pcavr
