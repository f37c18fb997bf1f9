// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/block_system.hpp"

#include <algorithm>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

NormalEquations equations_of(const JointRows& rows, Eigen::Index first, Eigen::Index count) {
  const Eigen::Index rigid = rows.rigid.cols(), library = rows.library.cols();
  Eigen::MatrixXd matrix(count, rigid + library);
  matrix.leftCols(rigid) = rows.rigid.middleRows(first, count);
  matrix.rightCols(library) = rows.library.middleRows(first, count);
  const Eigen::VectorXd root = rows.weight.segment(first, count).cwiseSqrt();
  matrix.array().colwise() *= root.array();
  const Eigen::VectorXd torque = rows.torque.segment(first, count).cwiseProduct(root);
  NormalEquations equations;
  equations.gram.setZero(matrix.cols(), matrix.cols());
  equations.gram.selfadjointView<Eigen::Lower>().rankUpdate(matrix.transpose());
  equations.gram.triangularView<Eigen::StrictlyUpper>() = equations.gram.transpose();
  equations.moment = matrix.transpose() * torque;
  equations.power = torque.squaredNorm();
  equations.count = rows.weight.segment(first, count).sum();
  return equations;
}

/// The places of each joint's selected columns among all unknowns.
std::vector<std::vector<Eigen::Index>> places_of(Eigen::Index rigid, const Selection& selection,
                                                 Eigen::Index& unknowns) {
  std::vector<std::vector<Eigen::Index>> places;
  unknowns = rigid;
  for (const std::vector<int>& columns : selection) {
    std::vector<Eigen::Index>& of_joint = places.emplace_back();
    for (std::size_t i = 0; i < columns.size(); ++i) of_joint.push_back(unknowns++);
  }
  return places;
}

/// Adds one joint's weighted equations to those of all unknowns.
void accumulate(const NormalEquations& joint, Eigen::Index rigid, const std::vector<int>& columns,
                const std::vector<Eigen::Index>& places, double weight, Eigen::MatrixXd& gram,
                Eigen::VectorXd& moment) {
  gram.topLeftCorner(rigid, rigid) += weight * joint.gram.topLeftCorner(rigid, rigid);
  moment.head(rigid) += weight * joint.moment.head(rigid);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Eigen::Index column = rigid + columns[i], place = places[i];
    const Eigen::VectorXd shared = weight * joint.gram.col(column).head(rigid);
    gram.col(place).head(rigid) += shared;
    gram.row(place).head(rigid) += shared.transpose();
    moment[place] += weight * joint.moment[column];
    for (std::size_t k = 0; k < columns.size(); ++k) {
      gram(place, places[k]) += weight * joint.gram(column, rigid + columns[k]);
    }
  }
}

}  // namespace

void NormalEquations::add(const NormalEquations& other) {
  if (gram.size() == 0) {
    *this = other;
    return;
  }
  gram += other.gram;
  moment += other.moment;
  power += other.power;
  count += other.count;
}

double NormalEquations::squared_error(const Eigen::VectorXd& parameters) const {
  return std::max(0.0, power - 2.0 * parameters.dot(moment) + parameters.dot(gram * parameters));
}

BlockSystem block_system(const std::vector<JointRows>& joints, Eigen::Index rows,
                         std::size_t blocks) {
  PCAVR_REQUIRE(!joints.empty() && blocks >= 1 && rows >= static_cast<Eigen::Index>(blocks), rows);
  BlockSystem system;
  system.rigid = joints.front().rigid.cols();
  system.library = joints.front().library.cols();
  const auto edge = [&](std::size_t block) {
    return rows * static_cast<Eigen::Index>(block) / static_cast<Eigen::Index>(blocks);
  };
  for (std::size_t block = 0; block < blocks; ++block) {
    std::vector<NormalEquations>& of_block = system.blocks.emplace_back();
    for (const JointRows& joint : joints) {
      of_block.push_back(equations_of(joint, edge(block), edge(block + 1) - edge(block)));
    }
  }
  return system;
}

Eigen::VectorXd FitSolution::of_joint(std::size_t joint) const {
  Eigen::VectorXd parameters(rigid.size() + library[joint].size());
  parameters << rigid, library[joint];
  return parameters;
}

FitSolution solve(const BlockSystem& system, const std::vector<bool>& use,
                  const Selection& selection, const Eigen::VectorXd& variance,
                  const FitPrior& prior, bool with_covariance) {
  Eigen::Index unknowns = 0;
  const auto places = places_of(system.rigid, selection, unknowns);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(unknowns);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(unknowns), std(unknowns);
  mean.head(system.rigid) = prior.mean;
  std.head(system.rigid) = prior.std;
  for (std::size_t j = 0; j < selection.size(); ++j) {
    NormalEquations sum;
    for (std::size_t block = 0; block < system.blocks.size(); ++block) {
      if (use[block]) sum.add(system.blocks[block][j]);
    }
    accumulate(sum, system.rigid, selection[j], places[j], 1.0 / variance[static_cast<int>(j)],
               gram, moment);
    for (std::size_t i = 0; i < places[j].size(); ++i) {
      std[places[j][i]] = prior.library_std[j][selection[j][i]];
    }
  }
  // In units of the prior's std, the matrix is the identity plus the data's part.
  moment -= gram * mean;
  const Eigen::MatrixXd scaled = (std.asDiagonal() * gram * std.asDiagonal()).eval() +
                                 Eigen::MatrixXd::Identity(unknowns, unknowns);
  const Eigen::LDLT<Eigen::MatrixXd> factors(scaled);
  FitSolution solution;
  solution.ordered =
      mean + std.cwiseProduct(factors.solve(Eigen::VectorXd(std.cwiseProduct(moment))));
  if (with_covariance) {
    solution.covariance = std.asDiagonal() *
                          factors.solve(Eigen::MatrixXd::Identity(unknowns, unknowns)) *
                          std.asDiagonal();
    const Eigen::VectorXd inverse = std.cwiseInverse();
    solution.information = inverse.asDiagonal() * scaled * inverse.asDiagonal();
  }
  set_ordered(std::move(solution.ordered), system, selection, solution);
  return solution;
}

Eigen::MatrixXd leave_out_changes(const BlockSystem& system, const Selection& selection,
                                  const Eigen::VectorXd& variance, const FitPrior& prior,
                                  const FitSolution& solution, std::size_t stretches) {
  PCAVR_REQUIRE(stretches >= 2 && stretches <= system.blocks.size(), stretches);
  Eigen::MatrixXd changes(solution.ordered.size(), static_cast<Eigen::Index>(stretches));
  for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
    std::vector<bool> use(system.blocks.size());
    for (std::size_t b = 0; b < use.size(); ++b) use[b] = b * stretches / use.size() != stretch;
    changes.col(static_cast<Eigen::Index>(stretch)) =
        solve(system, use, selection, variance, prior).ordered - solution.ordered;
  }
  return changes;
}

Eigen::MatrixXd jackknife_covariance(const Eigen::MatrixXd& changes) {
  const auto stretches = static_cast<double>(changes.cols());
  const Eigen::MatrixXd from_mean = changes.colwise() - changes.rowwise().mean();
  return (stretches - 1.0) / stretches * from_mean * from_mean.transpose();
}

void set_ordered(Eigen::VectorXd ordered, const BlockSystem& system, const Selection& selection,
                 FitSolution& solution) {
  solution.ordered = std::move(ordered);
  solution.rigid = solution.ordered.head(system.rigid);
  solution.library.assign(selection.size(), Eigen::VectorXd::Zero(system.library));
  Eigen::Index place = system.rigid;
  for (std::size_t j = 0; j < selection.size(); ++j) {
    for (const int column : selection[j]) solution.library[j][column] = solution.ordered[place++];
  }
}

}  // namespace pcavr
