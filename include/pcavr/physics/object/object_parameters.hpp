// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"
#include "pcavr/physics/friction/sliding_force.hpp"

namespace pcavr {

/// A value and, where known, its uncertainty.
struct ParameterValue {
  double value = 0.0;
  std::optional<double> std = {};  ///< standard deviation, in the value's unit
};

/// The sources of the values. Its keys are those of the parameter file; "contact.stiffness" is the
/// key stiffness of contact.
struct ParameterSources {
  std::vector<std::string> given = {};       ///< stated or assumed, not identified
  std::vector<std::string> correlated = {};  ///< identified together: the rows of `correlation`
  std::vector<double> correlation = {};      ///< coefficients, row by row
  std::map<std::string, int> pushes = {};    ///< by key: the pushes that a value rests on
  std::map<std::string, int> presses = {};   ///< by key: the presses
  std::map<std::string, int> impacts = {};   ///< by key: the impacts
  /// The recordings that the values rest on, by their content (content_id), ascending.
  std::vector<std::string> recordings = {};
};

/// The known contact and friction parameters of an object: what identification writes, prediction
/// reads and `truth/parameters.yaml` states. Empty: not known.
struct ObjectParameters {
  std::optional<ParameterValue> mass = {};  ///< M [kg]
  /// M [kg] by accelerations alone, beside a weighed one; nothing is predicted with it.
  std::optional<ParameterValue> inertial_mass = {};
  std::optional<ParameterValue> limiting_static_friction = {};  ///< F_M [N]
  /// Scatter of F_M from push to push [N]: half the critical band [paper C, eq. 10]. Where it is
  /// empty, the std of F_M is, as in files of older versions.
  std::optional<ParameterValue> limiting_static_friction_scatter = {};
  std::optional<ParameterValue> sliding_friction_coefficient = {};  ///< mu: Coulomb force over M g
  std::optional<ParameterValue> viscous_friction = {};              ///< B [N s/m]
  // F = stiffness d^n + damping d^n d' (n = 1: damping d').
  std::optional<ParameterValue> contact_stiffness = {};  ///< [N/m^n]
  std::optional<ParameterValue> contact_damping = {};    ///< [N s/m^(n+1)]
  std::optional<ParameterValue> contact_exponent = {};   ///< n
  /// m [kg] of F = m d'' + damping d' + stiffness d [paper C, eq. 2]: material that moves with the
  /// tool; with an exponent of 1 only.
  std::optional<ParameterValue> contact_mass = {};
  /// [m] by which the touched surface lies outside the CAD body's, along its normal in the object's
  /// frame: the errors of pose, mesh and tip radius with which the law was identified. On other
  /// faces their part along that normal counts. Empty: 0.
  std::optional<Eigen::Vector3d> contact_surface_offset = {};
  /// The law by which the damping follows from a restitution; empty: the damping is fitted to the
  /// force, or not known.
  std::optional<DampingLaw> contact_damping_law = {};
  /// c of impacts at `contact_impact_speed` [m/s]: by another law they give another damping.
  std::optional<ParameterValue> contact_restitution = {};
  std::optional<ParameterValue> contact_impact_speed = {};
  /// Maximum friction moment over maximum friction force of the support [m]; see mean_radius.
  std::optional<ParameterValue> friction_radius = {};
  std::optional<ParameterValue> tool_friction_coefficient = {};  ///< between tip and object
  std::optional<ParameterValue> loading_rate = {};  ///< [N/s] at which F_M was measured
  /// Known where pushes rotated the object enough. Axes: planar axes of the object, see heading_of.
  std::optional<LimitSurface> limit_surface = {};
  std::vector<SlidingForce> sliding_force = {};  ///< by ascending speed
  ParameterSources sources = {};
};

/// Removes the rows and columns of `keys` from the correlation.
void remove_correlation(const std::vector<std::string>& keys, ParameterSources& sources);
/// States that of `keys` in place of what is known of them; 0 with the others, which come from
/// another posterior. `covariance` in their order; where one has no variance, nothing is stated.
void set_correlation(const std::vector<std::string>& keys, const Eigen::MatrixXd& covariance,
                     ParameterSources& sources);

/// The coefficient of two keys, where one is stated.
[[nodiscard]] std::optional<double> correlation_of(const std::string& a, const std::string& b,
                                                   const ParameterSources& sources);

/// The contact law, if known. A stiffness without its exponent is in N/m.
[[nodiscard]] std::optional<HuntCrossley> contact_law_of(const ObjectParameters& known);

/// Relative std of the penetration (F / k)^(1/n) under the force F [N] > 0, to first order. Errors
/// of k and n compensate each other where presses showed both, so that their correlation is needed:
/// where none is stated, n counts as exact. Empty: k has no std.
[[nodiscard]] std::optional<double> penetration_std(const ObjectParameters& known, double force);

/// Parameters by the object's name.
using ParameterTable = std::map<std::string, ObjectParameters>;

}  // namespace pcavr
