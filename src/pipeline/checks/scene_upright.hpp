// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/pipeline/consistency.hpp"

namespace pcavr {

/// A scene whose movable objects stand on a surface that is not horizontal in base. A contradiction
/// where the quaternion of the only base tag, read as w x y z, makes it horizontal; else a warning.
/// Nothing where an object stands on a support plane, or where no surface is near the objects.
[[nodiscard]] std::optional<ConsistencyFinding> check_upright(const Manifest& manifest,
                                                              const Scene& scene);

}  // namespace pcavr
