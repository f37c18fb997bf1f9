// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The interval of the clouds that check_cloud_poses compares: 0, this, twice this, ...
[[nodiscard]] std::size_t compared_cloud_step(std::size_t clouds);

/// An Error for a contradiction between poses and thinned clouds: inverted, in millimetres, with
/// the quaternion's parts in another order, with swapped or mirrored axes (of positions, or of
/// whole poses), or of a left-handed frame. Each such hypothesis is compared with the poses as
/// given, on pairs of clouds along the sequence: it must leave much fewer points without one of the
/// other cloud. A warning where none explains that the clouds hardly overlap.
/// `voxel`: spacing of the points, and the distance within which two are the same [m].
[[nodiscard]] Expected<void> check_cloud_poses(
    const std::vector<Pose>& T_world_cloud,
    const std::vector<std::vector<Eigen::Vector3f>>& thinned_clouds, double voxel,
    const std::filesystem::path& file, Parallelism parallelism, const Observer& observer);

}  // namespace pcavr
