// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"

#include "survey.hpp"

namespace pcavr {

/// Why no frame could be placed in base, by what its tags and its depth showed.
[[nodiscard]] Error not_placed_error(const Recording& recording, const Survey& survey,
                                     const PerceptionOptions& options);

}  // namespace pcavr
