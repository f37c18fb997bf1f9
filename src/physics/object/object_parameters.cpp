// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object/object_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

std::optional<double> correlation_of(const std::string& a, const std::string& b,
                                     const ParameterSources& sources) {
  const std::vector<std::string>& names = sources.correlated;
  const auto row = std::find(names.begin(), names.end(), a);
  const auto column = std::find(names.begin(), names.end(), b);
  if (row == names.end() || column == names.end()) return std::nullopt;
  const auto index = (row - names.begin()) * std::ssize(names) + (column - names.begin());
  return sources.correlation[static_cast<std::size_t>(index)];
}

void remove_correlation(const std::vector<std::string>& keys, ParameterSources& sources) {
  const std::size_t count = sources.correlated.size();
  PCAVR_REQUIRE(sources.correlation.size() == count * count, sources.correlation.size(), count);
  const auto is_kept = [&](std::size_t i) {
    return std::find(keys.begin(), keys.end(), sources.correlated[i]) == keys.end();
  };
  std::vector<std::string> names;
  std::vector<double> coefficients;
  for (std::size_t row = 0; row < count; ++row) {
    if (!is_kept(row)) continue;
    names.push_back(sources.correlated[row]);
    for (std::size_t column = 0; column < count; ++column) {
      if (is_kept(column)) coefficients.push_back(sources.correlation[row * count + column]);
    }
  }
  sources.correlated = std::move(names);
  sources.correlation = std::move(coefficients);
}

void set_correlation(const std::vector<std::string>& keys, const Eigen::MatrixXd& covariance,
                     ParameterSources& sources) {
  const auto added = static_cast<Eigen::Index>(keys.size());
  PCAVR_REQUIRE(covariance.rows() == added && covariance.cols() == added, covariance.rows(), added);
  remove_correlation(keys, sources);
  if (!(covariance.diagonal().minCoeff() > 0.0)) return;
  const auto before = static_cast<Eigen::Index>(sources.correlated.size());
  Matrix all = Matrix::Identity(before + added, before + added);
  all.topLeftCorner(before, before) =
      Eigen::Map<const Matrix>(sources.correlation.data(), before, before);
  for (Eigen::Index row = 0; row < added; ++row) {
    for (Eigen::Index column = 0; column < row; ++column) {
      all(before + row, before + column) = all(before + column, before + row) =
          covariance(row, column) / std::sqrt(covariance(row, row) * covariance(column, column));
    }
  }
  sources.correlated.insert(sources.correlated.end(), keys.begin(), keys.end());
  sources.correlation.assign(all.data(), all.data() + all.size());
}

std::optional<HuntCrossley> contact_law_of(const ObjectParameters& known) {
  if (!known.contact_stiffness) return std::nullopt;
  HuntCrossley contact_law;
  contact_law.stiffness = known.contact_stiffness->value;
  if (known.contact_damping) contact_law.damping = known.contact_damping->value;
  if (known.contact_exponent) contact_law.exponent = known.contact_exponent->value;
  return contact_law;
}

std::optional<double> penetration_std(const ObjectParameters& known, double force) {
  PCAVR_REQUIRE(force > 0.0, force);
  if (!known.contact_stiffness || !known.contact_stiffness->std) return std::nullopt;
  const ParameterValue exponent = known.contact_exponent.value_or(ParameterValue{1.0, {}});
  const double stiffness = known.contact_stiffness->value;
  // d ln d = -(d ln k + ln d dn) / n.
  const double by_stiffness = *known.contact_stiffness->std / stiffness;
  const std::optional<double> correlation =
      correlation_of("contact.stiffness", "contact.exponent", known.sources);
  if (!correlation || !exponent.std) return by_stiffness / exponent.value;
  const double log_penetration = std::log(force / stiffness) / exponent.value;
  const double by_exponent = log_penetration * *exponent.std;
  const double variance = by_stiffness * by_stiffness + by_exponent * by_exponent +
                          2.0 * *correlation * by_stiffness * by_exponent;
  return std::sqrt(std::max(variance, 0.0)) / exponent.value;
}

}  // namespace pcavr
