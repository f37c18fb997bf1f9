// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/push_out.hpp"

#include <algorithm>
#include <cmath>

#include "physics/prediction/tip_contact.hpp"

namespace pcavr::detail {
namespace {

/// Number of parts of the path, since the body turns on it; as many more iterations correct the
/// remaining overlap.
constexpr int kPushOutParts = 4;
/// Normals with a smaller vertical component can push a body out sideways.
constexpr double kMaxNormalZ = 0.87;
constexpr double kPushedOut = 1e-7;  // [m] of penetration

}  // namespace

PlanarState pushed_out(const UprightBody& body, const PlanarState& planar,
                       const Eigen::Vector3d& p_base_tip, double radius,
                       const Eigen::Vector3d& entry_normal) noexcept {
  PlanarState result = planar;
  for (int left = kPushOutParts; left > -kPushOutParts; --left) {
    const TipContact contact =
        find_tip_contacts(body, result, p_base_tip, radius, entry_normal).deepest();
    const double excess = contact.depth - body.sliding_depth();
    if (std::abs(contact.normal.z()) > kMaxNormalZ || std::abs(excess) < kPushedOut) break;
    const Eigen::Vector2d flat = contact.normal.head<2>();
    const double distance = excess / (std::max(left, 1) * flat.norm());
    const Eigen::Vector3d displacement =
        distance * body.slow_push_twist(contact.arm, -flat.normalized(), result.yaw);
    result.position += displacement.head<2>();
    result.yaw += displacement.z();
  }
  return result;
}

}  // namespace pcavr::detail
