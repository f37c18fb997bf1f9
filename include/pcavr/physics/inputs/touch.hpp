// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/inputs/input_options.hpp"

namespace pcavr {

inline constexpr double kTouchSearchRadius = 0.2;  // [m] about the tip's centre

/// Distance and direction from the tool's tip to a body.
struct Touch {
  /// [m] between their surfaces, negative inside; infinite where the body is farther than that.
  double gap = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();  ///< of the closest face, outward
  /// Unit, from the tip's centre to the closest point of the surface: into the body; at an edge,
  /// between the two faces' normals.
  Eigen::Vector3d inward_base = Eigen::Vector3d::UnitX();
};

/// Closest-point queries to a body's CAD surface. Const and thread-safe.
class BodySurface {
 public:
  explicit BodySurface(const CadModel& model) : surface_(model.mesh_object) {}

  [[nodiscard]] Touch touch(const Pose& T_base_object, const Eigen::Vector3d& p_base_tip,
                            double tool_radius) const;

 private:
  SurfaceQuery surface_;
};

/// The body that a contact belongs to.
struct TouchedBody {
  std::size_t body = 0;       ///< index of the closest
  bool is_ambiguous = false;  ///< another one is nearly as close
};

/// The body whose surface is closest to the tip; nothing if all are farther than max_touch_gap.
[[nodiscard]] std::optional<TouchedBody> touched_body(std::span<const Touch> touches,
                                                      const InputOptions& options);

}  // namespace pcavr
