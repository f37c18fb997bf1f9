// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/turning/support.hpp"
#include "pcavr/physics/turning/turning.hpp"

namespace pcavr {

/// The friction radius [m] by the model that predicts best how pushes that it was not fitted to
/// turned the object: the CAD body's support, of this `shape`, at any size, or any limit surface,
/// as of an object on feet. Its std is by leaving out pushes, by that of the `viscous` friction [N
/// s/m], and by the pressure's unknown distribution. Empty where no push turned the object far
/// enough.
[[nodiscard]] std::optional<ParameterValue> friction_radius_of(
    const SamplesOfPushes& pushes, const Support& support, const LimitSurface& shape,
    const ParameterValue& viscous, const LimitSurfaceFitOptions& options);

/// The radius about the `centre` [m] of a pressure that a push has moved, over that about the
/// middle.
[[nodiscard]] double moved_radius_share(const Support& support, const Eigen::Vector2d& centre);

}  // namespace pcavr
