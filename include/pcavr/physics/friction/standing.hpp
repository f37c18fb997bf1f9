// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {

/// [m] z of the object's lowest vertex in base: of the plane that it stands on.
[[nodiscard]] double support_height(const CadModel& model, const Pose& T_base_object);

/// The centre of the support's pressure [m] under a horizontal `force` [N] at a `height` over the
/// support [m]. It lies ahead of the centre of mass in the force's direction, by the force's moment
/// over the weight. Where the weight [N] is not known, the force is taken to be a typical share of
/// it.
[[nodiscard]] Eigen::Vector2d centre_of_pressure(const Eigen::Vector2d& force, double height,
                                                 const std::optional<double>& weight);

/// [m] The gyration radius of the homogeneous object about the vertical through its centre of mass.
[[nodiscard]] double gyration_radius(const CadModel& model, const Pose& T_base_object);

}  // namespace pcavr
