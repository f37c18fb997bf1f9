// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// Mass properties of a body of uniform density with this mass [kg]. The inertia is that of its
/// mesh, also where that is simplified; the centre of mass is the model's.
[[nodiscard]] MassProperties mass_properties_of(const CadModel& model, double mass);

}  // namespace pcavr::detail
