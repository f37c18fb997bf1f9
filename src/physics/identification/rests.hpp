// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

struct SampleRange {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< one past the last
};

/// A tip that rests on an object after a push keeps a force that may be below the threshold of
/// contact, and would be taken for the bias. Samples next to one of the `contacts`, ascending,
/// whose force [N] drops to the bias only later are not free, and their `is_free` becomes false;
/// likewise before a contact that begins slowly. `force`: base axes, less its gross bias; `noise`
/// [N] std of one sample and axis; `max_drift` [N/s] of the bias. Pure but for `is_free`.
void exclude_rests(std::span<const double> t, std::span<const Eigen::Vector3d> force,
                   std::span<const SampleRange> contacts, double noise, double max_drift,
                   std::vector<bool>& is_free);

}  // namespace pcavr
