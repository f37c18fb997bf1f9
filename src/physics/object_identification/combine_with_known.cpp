// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object_identification/combine_with_known.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/physics/object_identification/run_scatter.hpp"

namespace pcavr {
namespace {

constexpr double kMaxDifference = 5.0;  // [stds] more is another object, or another surface

/// Keys whose values are from one posterior.
const std::array<std::vector<std::string>, 4>& groups() {
  static const std::array<std::vector<std::string>, 4> keys{{
      {"mass", "sliding_friction_coefficient", "viscous_friction"},
      {"limiting_static_friction"},
      {"friction_radius"},
      {"tool_friction_coefficient"},
  }};
  return keys;
}

bool is_uncertain(const std::optional<ParameterValue>& value) {
  return value && value->std && *value->std > 0.0 && std::isfinite(*value->std);
}

bool is_given(const std::string& key, const ParameterSources& sources) {
  return std::ranges::find(sources.given, key) != sources.given.end();
}

ParameterFinding* row_of(const std::string& key, ObjectIdentification& found) {
  const auto row = std::ranges::find(found.findings, key, &ParameterFinding::name);
  return row != found.findings.end() && row->is_excited ? &*row : nullptr;
}

Eigen::VectorXd values_of(const std::vector<std::string>& keys, ObjectParameters& parameters) {
  Eigen::VectorXd values(std::ssize(keys));
  for (std::size_t i = 0; i < keys.size(); ++i)
    values(static_cast<Eigen::Index>(i)) = (*find_parameter(keys[i], parameters))->value;
  return values;
}

Eigen::MatrixXd covariance_of(const std::vector<std::string>& keys, ObjectParameters& parameters) {
  Eigen::MatrixXd covariance(std::ssize(keys), std::ssize(keys));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    for (std::size_t j = 0; j < keys.size(); ++j) {
      const double correlation =
          i == j ? 1.0 : correlation_of(keys[i], keys[j], parameters.sources).value_or(0.0);
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          correlation * *(*find_parameter(keys[i], parameters))->std *
          *(*find_parameter(keys[j], parameters))->std;
    }
  }
  return covariance;
}

/// The keys of a group that both have, with a std.
std::vector<std::string> combinable(const std::vector<std::string>& group, ObjectParameters& before,
                                    ObjectIdentification& found) {
  std::vector<std::string> keys;
  for (const std::string& key : group) {
    if (row_of(key, found) == nullptr || is_given(key, before.sources)) continue;
    if (is_uncertain(*find_parameter(key, before)) &&
        is_uncertain(*find_parameter(key, found.parameters)))
      keys.push_back(key);
  }
  return keys;
}

std::optional<std::string> difference_note(const std::vector<std::string>& keys,
                                           ObjectParameters& before, ObjectParameters& now) {
  for (const std::string& key : keys) {
    const ParameterValue& old = **find_parameter(key, before);
    const ParameterValue& value = **find_parameter(key, now);
    const double difference = std::abs(value.value - old.value) / std::hypot(*value.std, *old.std);
    if (difference <= kMaxDifference) continue;
    return fmt::format(
        "{} was {:.4g} +- {:.2g} before, {:.0f} stds from what this shows: not combined, the new "
        "values replace it",
        key, old.value, *old.std, difference);
  }
  return std::nullopt;
}

void set_value(const std::string& key, double value, double std, const ParameterValue& old,
               ObjectIdentification& found) {
  ParameterValue& parameter = **find_parameter(key, found.parameters);
  const std::array<ParameterValue, 2> both{old, parameter};
  parameter = {value, std::hypot(std, scatter_of_runs(both).scatter / std::sqrt(2.0))};
  ParameterFinding& row = *row_of(key, found);
  row.value = parameter.value;
  row.std = parameter.std;
  row.remark += "; with the value known before";
}

void combine(const std::vector<std::string>& keys, ObjectParameters& before,
             ObjectIdentification& found) {
  const Eigen::MatrixXd old_information = covariance_of(keys, before).inverse();
  const Eigen::MatrixXd new_information = covariance_of(keys, found.parameters).inverse();
  if (!old_information.allFinite() || !new_information.allFinite()) return;
  const Eigen::MatrixXd covariance = (old_information + new_information).inverse();
  const Eigen::VectorXd values = covariance * (old_information * values_of(keys, before) +
                                               new_information * values_of(keys, found.parameters));
  if (!values.allFinite() || !(covariance.diagonal().minCoeff() > 0.0) || values.minCoeff() < 0.0)
    return;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    set_value(keys[i], values(k), std::sqrt(covariance(k, k)), **find_parameter(keys[i], before),
              found);
  }
  if (keys.size() > 1) set_correlation(keys, covariance, found.parameters.sources);
}

bool has_common(const std::vector<std::string>& one, const std::vector<std::string>& other) {
  return std::ranges::any_of(
      one, [&](const std::string& id) { return std::ranges::find(other, id) != other.end(); });
}

}  // namespace

void combine_with_known(const ObjectParameters& before, ObjectIdentification& found) {
  ObjectParameters old = before;
  const bool is_same_data = has_common(before.sources.recordings, found.recordings);
  bool is_noted = false;
  for (const std::vector<std::string>& group : groups()) {
    const std::vector<std::string> keys = combinable(group, old, found);
    if (keys.empty()) continue;
    if (is_same_data) {
      if (!std::exchange(is_noted, true))
        found.notes.emplace_back(
            "the friction known before is from this recording, too: not combined, the new values "
            "replace it");
      continue;
    }
    if (const auto note = difference_note(keys, old, found.parameters)) {
      found.notes.push_back(*note);
      continue;
    }
    combine(keys, old, found);
  }
}

}  // namespace pcavr
