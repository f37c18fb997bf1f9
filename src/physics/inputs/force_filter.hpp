// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"

namespace pcavr {

/// The fault of a force that is behind a slow low pass of first order, as drivers of sensors set
/// it. After contacts it falls exponentially, with one time constant whatever the tip does, where
/// contact laws end at a finite time; and without contact its noise is correlated over that time.
/// Both have to show. No delay corrects it: forces that change faster are not in the data.
[[nodiscard]] std::optional<InputFault> force_filter_fault(const Segmentation& found,
                                                           std::span<const double> t_force);

}  // namespace pcavr
