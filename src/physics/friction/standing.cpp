// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/standing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/LU>

namespace pcavr {
namespace {

constexpr double kTypicalCoefficient = 0.3;  // force over weight, where the weight is not known

}  // namespace

double support_height(const CadModel& model, const Pose& T_base_object) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& vertex : model.mesh_object.vertices) {
    lowest = std::min(lowest, (T_base_object * vertex.cast<double>()).z());
  }
  return lowest;
}

Eigen::Vector2d centre_of_pressure(const Eigen::Vector2d& force, double height,
                                   const std::optional<double>& weight) {
  const double bearing = weight.value_or(force.norm() / kTypicalCoefficient);
  return bearing > 0.0 ? Eigen::Vector2d(height / bearing * force) : Eigen::Vector2d::Zero();
}

double gyration_radius(const CadModel& model, const Pose& T_base_object) {
  const Eigen::Vector3d centre = T_base_object * model.centre_of_mass_object;
  const Pose T_centre_object =
      Pose::from_translation({-centre.x(), -centre.y(), 0.0}) * T_base_object;
  // The sum over the tetrahedra between the triangles and the origin, in closed form.
  double volume = 0.0;
  double moment = 0.0;
  for (const auto& t : model.mesh_object.triangles) {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) {
      corners.col(i) = T_centre_object *
                       model.mesh_object.vertices[t[static_cast<std::size_t>(i)]].cast<double>();
    }
    const double tetrahedron = corners.determinant() / 6.0;
    const Eigen::Matrix<double, 2, 3> flat = corners.topRows<2>();
    volume += tetrahedron;
    moment += tetrahedron / 20.0 * (flat.squaredNorm() + flat.rowwise().sum().squaredNorm());
  }
  return std::sqrt(moment / volume);
}

}  // namespace pcavr
