// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/mass_properties.hpp"

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::detail {

MassProperties mass_properties_of(const CadModel& model, double mass) {
  // The tetrahedra between the triangles and the centre of mass, in closed form: the second moment
  // of one with corners a, b, c and the origin is V / 20 (a a' + b b' + c c' + s s'), s = a + b +
  // c.
  double volume = 0.0;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  for (const auto& triangle : model.mesh_object.triangles) {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) {
      corners.col(i) =
          model.mesh_object.vertices[triangle[static_cast<std::size_t>(i)]].cast<double>() -
          model.centre_of_mass_object;
    }
    const double tetrahedron = corners.determinant() / 6.0;
    const Eigen::Vector3d sum = corners.rowwise().sum();
    volume += tetrahedron;
    first += tetrahedron / 4.0 * sum;
    second += tetrahedron / 20.0 * (corners * corners.transpose() + sum * sum.transpose());
  }
  const Eigen::Vector3d centre = first / volume;  // zero but for a simplified mesh
  const Eigen::Matrix3d spread = second / volume - centre * centre.transpose();
  return {.mass = mass,
          .centre_of_mass_object = model.centre_of_mass_object,
          .inertia_object = mass * (spread.trace() * Eigen::Matrix3d::Identity() - spread)};
}

}  // namespace pcavr::detail
