// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/identification/contact.hpp"

namespace pcavr {

/// A body that the tool may touch. Refers to its model and series, which must outlive it.
struct InputBody {
  std::string name;
  const CadModel* model = nullptr;
  Pose T_base_object;                         ///< at the start
  std::optional<double> mass = {};            ///< [kg] where it was weighed
  std::span<const TrackedPose> tracked = {};  ///< may be empty: its motion follows from the pushes
  bool is_movable = true;                     ///< false: it stays at T_base_object
};

/// The measured series of one recording, or of a part of it, on one clock: base frame, SI, stamps
/// ascending strictly. A view: what it refers to must outlive it.
struct InputSeries {
  std::vector<InputBody> bodies = {};
  double tool_radius = 0.01;  ///< [m] of the spherical tip
  std::span<const double> t_tool = {};
  std::span<const Eigen::Vector3d> p_base_tip = {};
  /// The tool's orientations at `t_tool`. May be empty: then a force in the tool's axes is not
  /// recognised as such.
  std::span<const Eigen::Quaterniond> q_base_tool = {};
  std::span<const double> t_force = {};
  std::span<const Eigen::Vector3d> force_base = {};  ///< that the tool exerts [N]
};

}  // namespace pcavr
