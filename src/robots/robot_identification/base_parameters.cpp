// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/base_parameters.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr int kStates = 60;            ///< each has as many rows as joints
constexpr double kDependent = 1e-8;    ///< squared norm of a column's rest over its own
constexpr double kNoEffect = 1e-18;    ///< squared norm over the largest: zero but for rounding
constexpr double kSmallShare = 1e-6;   ///< coefficients below this are rounding
constexpr double kExcitedShare = 0.5;  ///< of the prior's std that the data must go below

constexpr std::array<const char*, 10> kNames{"m",   "mx",  "my",  "mz",  "Ixx",
                                             "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};

/// Sum of regressor' regressor over random states.
Eigen::MatrixXd structural_gram(const RobotModel& model) {
  const auto dof = static_cast<Eigen::Index>(model.dof);
  Random random(kSeed);
  RobotDynamics dynamics(model);
  Eigen::MatrixXd regressor(dof, 10 * dof);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(10 * dof, 10 * dof);
  Eigen::VectorXd q(dof), dq(dof), ddq(dof);
  for (int state = 0; state < kStates; ++state) {
    for (Eigen::Index j = 0; j < dof; ++j) {
      q[j] = random.uniform(-3.0, 3.0);
      dq[j] = random.uniform(-2.0, 2.0);
      ddq[j] = random.uniform(-5.0, 5.0);
    }
    dynamics.regressor(q, dq, ddq, regressor);
    gram += regressor.transpose() * regressor;
  }
  return gram;
}

/// Columns that are not combinations of earlier chosen ones, from the last link to the first: a
/// dependent column joins the links behind it.
std::vector<Eigen::Index> independent_columns(const Eigen::MatrixXd& gram) {
  Eigen::MatrixXd rest = gram;
  const double largest = gram.diagonal().maxCoeff();
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = gram.cols() - 1; k >= 0; --k) {
    const double norm = rest(k, k);
    if (gram(k, k) <= kNoEffect * largest || norm <= kDependent * gram(k, k)) continue;
    columns.push_back(k);
    const Eigen::VectorXd column = rest.col(k);
    rest -= column * column.transpose() / norm;
  }
  return columns;
}

std::string name_of_column(const RobotModel& model, Eigen::Index column) {
  return fmt::format("{}({})", kNames[static_cast<std::size_t>(column % 10)],
                     model.joints[static_cast<std::size_t>(column / 10)].name);
}

}  // namespace

std::vector<BaseParameter> base_parameters(const RobotModel& model,
                                           const Eigen::VectorXd& parameters,
                                           const Eigen::MatrixXd& covariance,
                                           const Eigen::VectorXd& prior_std) {
  const Eigen::MatrixXd gram = structural_gram(model);
  const std::vector<Eigen::Index> columns = independent_columns(gram);
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd own(count, count), all(count, gram.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    all.row(i) = gram.row(columns[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < count; ++k) {
      own(i, k) = gram(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(k)]);
    }
  }
  // Row i: how much of each parameter goes into base parameter i.
  const Eigen::MatrixXd shares = own.ldlt().solve(all);
  std::vector<BaseParameter> base;
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    const Eigen::RowVectorXd share = shares.row(i);
    BaseParameter& entry = base.emplace_back();
    entry.name = name_of_column(model, columns[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < share.size(); ++k) {
      if (k == columns[static_cast<std::size_t>(i)] || std::abs(share[k]) < kSmallShare) continue;
      entry.name += fmt::format(" {} {:.3g} {}", share[k] < 0.0 ? '-' : '+', std::abs(share[k]),
                                name_of_column(model, k));
    }
    entry.value = share.dot(parameters);
    entry.std = std::sqrt(std::max(0.0, (share * covariance * share.transpose()).value()));
    entry.prior_std = share.transpose().cwiseProduct(prior_std).norm();
    entry.is_excited = entry.std < kExcitedShare * entry.prior_std;
  }
  return base;
}

}  // namespace pcavr
