// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// A foot's contact with the support. Its centre is so deep that the foot bears its load while the
/// body is in its recorded pose.
struct FootContact {
  double stiffness = 0.0;                                   ///< [N/m]
  double damping = 0.0;                                     ///< [N s/m], critical
  Eigen::Vector3d centre_object = Eigen::Vector3d::Zero();  ///< [m]
};

/// Of engines with a stiffness for each foot: it sinks by 20 um under its load.
[[nodiscard]] FootContact stiff_foot_contact(const ExportedBody& body, const SupportFoot& foot,
                                             const Eigen::Vector3d& up_base);

/// Of engines with one stiffness [N/m] for a body.
[[nodiscard]] FootContact foot_contact(const ExportedBody& body, const SupportFoot& foot,
                                       const Eigen::Vector3d& up_base, double stiffness);

}  // namespace pcavr::detail
