// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace pcavr {

/// The groups in which pushes are left out: successive ones together, as they share friction that
/// drifts; not more, as a median depends on few of many.
inline constexpr std::size_t kJackknifeGroups = 10;
[[nodiscard]] constexpr std::size_t jackknife_groups(std::size_t pushes) {
  return pushes < kJackknifeGroups ? pushes : kJackknifeGroups;
}
[[nodiscard]] constexpr std::size_t jackknife_group(std::size_t push, std::size_t pushes) {
  return push * jackknife_groups(pushes) / pushes;
}

/// The std of an estimate by the same estimate without each group of its data [Tukey 1958]:
/// samples of one group may depend on each other. Widened to the std of Student's distribution, as
/// few groups say little of their scatter. Needs at least two.
[[nodiscard]] double jackknife_std(std::span<const double> without_group);

}  // namespace pcavr
