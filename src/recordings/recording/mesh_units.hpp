// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

namespace pcavr {

/// The units of a mesh's coordinates that a manifest may name [m].
inline constexpr std::array<std::pair<const char*, double>, 4> kMeshUnits{
    {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 25.4e-3}}};

}  // namespace pcavr
