// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The centroids of a cloud's points (NaN: not measured) in cubes of edge `voxel` [m], by PCL's
/// voxel grid.
[[nodiscard]] std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points,
                                                   double voxel);

/// The agreement of two clouds.
struct CloudAgreement {
  double overlap = 0.0;  ///< share of b's points with one of a within the tolerance
  double rms = 0.0;      ///< distance of these [m]
};
/// The agreement by each of several poses of b in a. `tolerance` in metres. O((n_a + m n_b) log
/// n_a) for m poses.
[[nodiscard]] std::vector<CloudAgreement> compare_clouds(
    const std::vector<Eigen::Vector3f>& points_a, const std::vector<Eigen::Vector3f>& points_b,
    const std::vector<Pose>& T_a_b, double tolerance);

struct AlignmentOptions {
  double voxel = 0.02;  ///< spacing of the points [m], > 0
  /// A cloud with less overlap with all reference clouds is not aligned.
  double min_overlap = 0.35;
  /// Below this overlap with the last reference cloud the next cloud becomes one.
  double reference_overlap = 0.75;
};

struct CloudAlignment {
  std::vector<Pose> T_world_cloud;  ///< world is the frame of the first cloud
  double rms = 0.0;                 ///< between each cloud and its reference, all points [m]
  double min_overlap = 1.0;
  std::size_t references = 0;
  std::size_t by_features = 0;  ///< clouds whose initial pose came from features
  /// The first cloud that overlaps no other one before it; the poses end before it.
  std::optional<std::size_t> failed = {};
};

/// Aligns the thinned clouds of a sequence with each other: each with the last reference cloud by
/// generalised ICP [Segal, Haehnel & Thrun 2009], starting from the previous cloud's pose; where
/// the overlap is small then, also from matches of FPFH features [Rusu, Blodow & Beetz 2009] by
/// RANSAC, with any reference cloud where there is none. The larger overlap is taken. All by PCL.
/// Deterministic.
[[nodiscard]] CloudAlignment align_clouds(const std::vector<std::vector<Eigen::Vector3f>>& clouds,
                                          const AlignmentOptions& options,
                                          const Observer& observer = {});

}  // namespace pcavr
