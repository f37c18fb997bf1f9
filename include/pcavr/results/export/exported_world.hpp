// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {

/// A number of an exported world, and what it rests on.
struct ExportedNumber {
  std::string object;
  std::string key;  ///< as in parameter files: "mass", "contact_stiffness"
  double value = 0.0;
  std::optional<double> std = {};  ///< in the value's unit
  std::string unit;
  std::string origin;  ///< "measured", "given" or "assumed"
};

/// Difference between what was identified and what a mapping wrote.
struct ExportResidual {
  std::string object;
  std::string what;      ///< "turning torque", "contact force at 2.0 N"
  double wanted = 0.0;   ///< by the identified parameters
  double written = 0.0;  ///< by what was written, as the engine's equations have it
  std::string unit;
  std::string remark = {};

  /// Residual over the wanted value; 0 where that is 0.
  [[nodiscard]] double relative() const { return wanted == 0.0 ? 0.0 : written / wanted - 1.0; }
};

/// A small sphere on which a body stands. Engines turn a box on its corners, which is 1.8 to 2.3
/// times too stiff; feet at the identified friction radius give the identified turning torque.
struct SupportFoot {
  Eigen::Vector3d centre_object = Eigen::Vector3d::Zero();  ///< [m]
  double radius = 0.0;                                      ///< [m]
  double friction = 0.0;                                    ///< coefficient
  double load = 0.0;                                        ///< share of the weight at rest
};

/// Mass, centre of mass and inertia of a body of uniform density.
struct MassProperties {
  double mass = 0.0;                                                ///< [kg]
  Eigen::Vector3d centre_of_mass_object = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Matrix3d inertia_object = Eigen::Matrix3d::Identity();     ///< about it [kg m^2]
};

/// A body of the scene as engines take it.
struct ExportedBody {
  std::string name;
  bool is_movable = true;
  Pose T_base_object;
  TriangleMesh mesh_object;  ///< closed
  bool is_convex = true;     ///< the mesh; engines that take the convex hull fill its concavities
  double max_concavity =
      0.0;  ///< [m] depth of the deepest vertex below a face's plane's outer side
  MassProperties inertia;
  /// [m] The touched faces' measured offset; see ObjectParameters::contact_surface_offset.
  Eigen::Vector3d surface_offset_object = Eigen::Vector3d::Zero();
  std::vector<SupportFoot> feet;
  /// Friction on the support over the weight at the reference speed, all parts of it.
  double friction = 0.0;
  double static_friction = 0.0;   ///< F_M over the weight
  double coulomb_friction = 0.0;  ///< Coulomb force over the weight
  double viscous = 0.0;           ///< B [N s/m]
  double stribeck_speed = 0.0;    ///< [m/s]; 0: none
  double friction_radius = 0.0;   ///< [m]
  double tool_friction = 0.0;     ///< between tip and body
  HuntCrossley contact;
  double working_force = 0.0;  ///< [N] of the tip, at which stiffnesses are matched
};

/// A support plane as a box: engines' spheres touch boxes exactly.
struct ExportedSupport {
  std::string name;
  Pose T_base_box;                                 ///< of its centre; z: the plane's normal
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< [m] edges
};

struct ExportedTool {
  std::string name;
  double radius = 0.0;  ///< [m] of the spherical tip
  Pose T_base_tool;
};

/// The content of all formats. Frame: base, gravity along -up_base. Bodies have the recording's
/// names; base, supports, scan and tool have names that no body has. A value: threads may read it
/// at the same time.
struct ExportedWorld {
  std::string source;  ///< the scene's recording
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();
  double reference_speed = 0.0;  ///< [m/s] at which the friction coefficients hold
  std::vector<ExportedBody> bodies;
  std::vector<ExportedSupport> supports;
  std::string base_name = "base";  ///< of the frame
  std::string scan_name = "scan";
  TriangleMesh scan_base;                     ///< may be empty
  std::filesystem::path occupancy_file = {};  ///< the scene's OctoMap; empty without a scan
  ExportedTool tool;
  std::vector<ExportedNumber> numbers;
  std::vector<ExportResidual> residuals;
  std::vector<std::string> warnings;

  /// Whether a scan shows what is fixed. Supports are then not drawn: they are within its noise,
  /// and both together would flicker.
  [[nodiscard]] bool is_scanned() const { return !scan_base.triangles.empty(); }
};

}  // namespace pcavr
