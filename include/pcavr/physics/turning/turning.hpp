// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/input_series.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/turning/body_motion.hpp"
#include "pcavr/physics/turning/support.hpp"

namespace pcavr {

/// Mean wrench and twist [m/s, rad/s] of the object over successive parts of a push in which it
/// slid, each of some millimetres; in the planar axes of `heading_of`, about the centre of
/// pressure. A push as slow as the noise of the tip's speed counts where tracking shows that it
/// moved the object. The pressure's centre follows from the push's height and the object's weight
/// [N].
[[nodiscard]] std::vector<PushSample> turning_samples(const Contact& push, const BodyMotion& body,
                                                      const PathView& tip, double tool_radius,
                                                      const std::optional<double>& weight);

/// The samples of some pushes, by the push that they are from.
using SamplesOfPushes = std::vector<std::vector<PushSample>>;
[[nodiscard]] std::vector<PushSample> joined(const SamplesOfPushes& pushes);

/// The samples as they would be under a pressure that no push has moved, which limit surfaces and
/// radii are for. Where the radius of the `support` has shrunk, moments are smaller and it turns
/// more, by the same factor.
[[nodiscard]] std::vector<PushSample> of_even_pressure(std::vector<PushSample> samples,
                                                       const Support& support);

/// The samples under Coulomb friction alone: without the load of the `support`'s viscous friction
/// [N s/m].
[[nodiscard]] std::vector<PushSample> without_viscous_load(std::vector<PushSample> samples,
                                                           const Support& support, double viscous);

/// Friction of an object that turns.
struct TurningFriction {
  /// Fitted where the radius is known, with the shape of the body's support as its prior.
  LimitSurfaceFit surface;
  /// [m] Maximum friction moment over maximum friction force; empty: no push has turned the object
  /// far enough, or its std, by leaving out pushes, is no third of the prior's.
  std::optional<ParameterValue> radius = {};
};
/// `viscous`: B [N s/m] of the object, whose load is no part of either; its std is one of the
/// radius.
[[nodiscard]] TurningFriction identify_turning(const SamplesOfPushes& pushes,
                                               const BodyMotion& body,
                                               const ParameterValue& viscous,
                                               const LimitSurfaceFitOptions& options);

/// The limit surface of uniform pressure on the body's support, scaled to a friction radius [m].
[[nodiscard]] LimitSurface surface_of_support(const CadModel& model, const Pose& T_base_object,
                                              double radius);

}  // namespace pcavr
