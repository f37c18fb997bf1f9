// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/format_residuals.hpp"

#include <fmt/core.h>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr::detail {

void add_static_friction_residual(const ExportedBody& body, const std::string& remark,
                                  ExportedWorld& world) {
  if (!body.is_movable) return;
  const double weight = body.inertia.mass * kStandardGravity;
  world.residuals.push_back({.object = body.name,
                             .what = "limiting static friction",
                             .wanted = body.static_friction * weight,
                             .written = body.friction * weight,
                             .unit = "N",
                             .remark = remark});
}

void add_penetration_residual(const ExportedBody& body, double stiffness, ExportedWorld& world) {
  world.residuals.push_back({.object = body.name,
                             .what = fmt::format("penetration at {:.3g} N", body.working_force),
                             .wanted = 1e3 * static_penetration(body.contact, body.working_force),
                             .written = 1e3 * body.working_force / stiffness,
                             .unit = "mm",
                             .remark = "linear contact of the identified stiffness at this force"});
}

Expected<void> check_reserved_name(const ExportedWorld& world, const std::string& reserved,
                                   const std::string& format) {
  for (const ExportedBody& body : world.bodies) {
    if (body.name != reserved) continue;
    return Error{.message = fmt::format("object '{}': {} reserves this name", body.name, format),
                 .hint = "rename the object in the recording, and build the scene again"};
  }
  return {};
}

}  // namespace pcavr::detail
