// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/sample_parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "physics/object/parameter_fields.hpp"

namespace pcavr {
namespace {

constexpr int kMaxDraws = 1000;

/// Conditions of the identification, or spread that a mean's std is not about.
constexpr std::array<std::string_view, 4> kKept{"inertial_mass", "limiting_static_friction_scatter",
                                                "loading_rate", "contact.impact_speed"};

struct Uncertain {
  std::string key;
  const parameter_file::Field* field;
  double mean = 0.0, std = 0.0;
};

std::vector<Uncertain> uncertain_of(const ObjectParameters& known) {
  std::vector<Uncertain> rows;
  const auto list = [&](const parameter_file::Field& field, const std::string& prefix) {
    const std::optional<ParameterValue>& value = known.*field.member;
    const std::string key = prefix + field.key;
    const bool is_kept = std::find(kKept.begin(), kKept.end(), key) != kKept.end();
    if (is_kept || !value || !value->std || !(*value->std > 0.0) || !(value->value > 0.0)) return;
    rows.push_back({key, &field, value->value, *value->std});
  };
  for (const parameter_file::Field& field : parameter_file::kFields) list(field, "");
  for (const parameter_file::Field& field : parameter_file::kContactFields) list(field, "contact.");
  return rows;
}

/// A square root of the correlation. Coefficients of a file are rounded: what is negative is 0.
Eigen::MatrixXd root_of_correlation(const std::vector<Uncertain>& rows,
                                    const ParameterSources& sources) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const auto& a = rows[static_cast<std::size_t>(i)];
      const auto& b = rows[static_cast<std::size_t>(j)];
      correlation(i, j) = correlation_of(a.key, b.key, sources).value_or(0.0);
      correlation(j, i) = correlation(i, j);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
  const Eigen::VectorXd roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return solver.eigenvectors() * roots.asDiagonal();
}

/// The value at `normal` stds of a log-normal distribution with this mean and std.
double log_normal(const Uncertain& row, double normal) {
  const double relative = row.std / row.mean;
  const double variance = std::log1p(relative * relative);
  return row.mean * std::exp(std::sqrt(variance) * normal - 0.5 * variance);
}

/// Coulomb and viscous friction at a speed [N], where they are known.
std::optional<double> sliding_friction(const ObjectParameters& known, double speed) {
  if (!known.mass || !known.sliding_friction_coefficient) return std::nullopt;
  const double viscous = known.viscous_friction ? known.viscous_friction->value : 0.0;
  return known.sliding_friction_coefficient->value * known.mass->value * kStandardGravity +
         viscous * speed;
}

/// The forces at the pushed speeds are of the same friction: they change with what was drawn of it.
void scale_sliding_forces(const ObjectParameters& known, ObjectParameters& drawn) {
  for (SlidingForce& row : drawn.sliding_force) {
    const std::optional<double> before = sliding_friction(known, row.speed);
    const std::optional<double> after = sliding_friction(drawn, row.speed);
    if (before && after && *before > 0.0) row.force *= *after / *before;
  }
}

}  // namespace

ObjectParameters sample_parameters(const ObjectParameters& known, Random& random) {
  ObjectParameters drawn = known;
  drawn.sources.correlated.clear();
  drawn.sources.correlation.clear();
  const std::vector<Uncertain> rows = uncertain_of(known);
  if (rows.empty()) return drawn;
  const Eigen::MatrixXd root = root_of_correlation(rows, known.sources);
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    Eigen::VectorXd independent(root.cols());
    for (double& normal : independent) normal = random.normal();
    const Eigen::VectorXd normals = root * independent;
    bool is_in_range = true;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = log_normal(rows[i], normals[static_cast<Eigen::Index>(i)]);
      is_in_range = is_in_range && rows[i].field->range.contains(value);
      drawn.*rows[i].field->member =
          ParameterValue{rows[i].field->range.contains(value) ? value : rows[i].mean, rows[i].std};
    }
    if (is_in_range) break;
  }
  scale_sliding_forces(known, drawn);
  return drawn;
}

}  // namespace pcavr
