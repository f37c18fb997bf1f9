// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/scene/scene.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// A body that may rest on a support plane: its surface and its pose in base.
struct SupportedBody {
  std::string name;
  const TriangleMesh* mesh_object = nullptr;
  Pose T_base_object;
};

/// See src/perception/scene/options.cpp for meanings, ranges and defaults.
struct SupportPlaneOptions {
  SupportPlaneOptions();

  double max_slope;            ///< [rad]
  double max_gap;              ///< [m]
  double search_margin;        ///< [m]
  double max_inlier_distance;  ///< [m]
  double min_inlier_distance;  ///< [m]
  double cluster_gap;          ///< [m]
  int min_points;
};

/// The options "scene.support_planes".
[[nodiscard]] OptionSection section_of(SupportPlaneOptions& options);

/// The support planes of the bodies: near-horizontal planes of the static mesh close to the lower
/// side of each body (RANSAC by PCL, then least squares on the inliers); bodies may share one.
/// Without bodies: the largest near-horizontal plane.
[[nodiscard]] std::vector<SupportPlane> find_support_planes(
    const TriangleMesh& mesh_base, const std::vector<SupportedBody>& bodies,
    const SupportPlaneOptions& options = {});

}  // namespace pcavr
