// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// Bias [N] of a force at each of its stamps, before its contacts are known. From the smallest of
/// the short-time means it is followed both ways, by at most `max_drift` [N/s], through what lies
/// within `nearness` [N] of it: a bias that drifts beyond a contact's threshold is not taken for
/// one. `t` ascending, at least partly free of contact.
[[nodiscard]] std::vector<Eigen::Vector3d> first_bias(std::span<const double> t,
                                                      std::span<const Eigen::Vector3d> force,
                                                      double nearness, double max_drift);

}  // namespace pcavr
