// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/foot_contact.hpp"

#include <cmath>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr::detail {
namespace {

constexpr double kSink = 2e-5;  // [m] of feet under the weight: below any identified geometry

double load_on(const ExportedBody& body, const SupportFoot& foot) {
  return foot.load * body.inertia.mass * kStandardGravity;
}

}  // namespace

FootContact foot_contact(const ExportedBody& body, const SupportFoot& foot,
                         const Eigen::Vector3d& up_base, double stiffness) {
  const double sink = load_on(body, foot) / stiffness;
  const Eigen::Vector3d up_object = body.T_base_object.rotation().inverse() * up_base;
  return {.stiffness = stiffness,
          .damping = 2.0 * std::sqrt(stiffness * foot.load * body.inertia.mass),
          .centre_object = foot.centre_object - sink * up_object};
}

FootContact stiff_foot_contact(const ExportedBody& body, const SupportFoot& foot,
                               const Eigen::Vector3d& up_base) {
  return foot_contact(body, foot, up_base, load_on(body, foot) / kSink);
}

}  // namespace pcavr::detail
