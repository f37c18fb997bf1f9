// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// Stds of the coefficients of `found.surface`, in its scales, which count as exact: by leaving out
/// groups of pushes that follow each other [jackknife, Efron & Stein 1981]. Empty where no surface
/// was fitted, or fewer than two groups show one. `T_base_object`: a pose of the object on its
/// support. A fit for each of ten groups.
[[nodiscard]] std::optional<std::array<double, 15>> surface_std_of(
    const ObjectIdentification& found, const CadModel& model, const Pose& T_base_object,
    const LimitSurfaceFitOptions& options);

}  // namespace pcavr
