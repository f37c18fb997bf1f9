// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "pcavr/physics/identification/contact.hpp"
#include "pcavr/physics/identification/path_view.hpp"

namespace pcavr {

/// Sets a contact's lever arm about the centre of mass; where the touched face's normal agrees with
/// the force, the series are projected onto it, or onto the same face's direction of earlier
/// contacts (`directions_base`), which is more exact than the mean force's: true then.
/// The contact's `T_base_object` and `normal_object` are set.
bool align_with_face(const Eigen::Vector3d& centre_of_mass_object, const PathView& tip,
                     std::span<const Eigen::Vector3d> directions_base, Contact& contact);

}  // namespace pcavr
