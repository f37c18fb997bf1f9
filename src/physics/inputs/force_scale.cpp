// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/force_scale.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/doubted.hpp"

#include "physics/inputs/faults.hpp"

namespace pcavr {
namespace {

/// Relative std of a weighed mass: a scale for kitchens, and what was added since.
constexpr double kWeighingStd = 0.02;
constexpr double kContradiction = 4.0;  // stds
/// Stds within which several objects have the same factor.
constexpr double kSameFactor = 3.0;

/// The mass by accelerations over the weighed one, as a logarithm.
struct Factor {
  const WeighedObject* object = nullptr;
  double log = 0.0, std = 0.0;
};

std::optional<Factor> factor_of(const WeighedObject& object) {
  if (!object.mass.is_excited || !(object.mass.value > 0.0)) return std::nullopt;
  return Factor{&object, std::log(object.mass.value / object.weighed_mass),
                std::hypot(object.mass.std / object.mass.value, kWeighingStd)};
}

std::vector<Factor> factors_of(std::span<const WeighedObject> objects) {
  std::vector<Factor> factors;
  for (const WeighedObject& object : objects) {
    if (const std::optional<Factor> factor = factor_of(object)) factors.push_back(*factor);
  }
  return factors;
}

bool is_contradiction(const Factor& factor) {
  return std::abs(factor.log) > kContradiction * factor.std;
}

std::string masses_text(const WeighedObject& object) {
  return object.name + fmt::format(
                           " has a mass of {:.3g} +- {:.2g} kg by force and acceleration, "
                           "and of {:.3g} kg by the manifest",
                           object.mass.value, object.mass.std, object.weighed_mass);
}

struct CommonFactor {
  double value = 1.0, std = 0.0;
};

/// The factor that all objects have; nothing where they differ, or for one of them alone.
std::optional<CommonFactor> common_factor(const std::vector<Factor>& factors) {
  if (std::count_if(factors.begin(), factors.end(), is_contradiction) < 2) return std::nullopt;
  double sum = 0.0, weights = 0.0;
  for (const Factor& one : factors) {
    const double weight = 1.0 / (one.std * one.std);
    sum += weight * one.log;
    weights += weight;
  }
  const double mean = sum / weights;
  const bool is_same = std::all_of(factors.begin(), factors.end(), [&](const Factor& one) {
    return std::abs(one.log - mean) < kSameFactor * one.std;
  });
  if (!is_same) return std::nullopt;
  return CommonFactor{std::exp(mean), std::exp(mean) / std::sqrt(weights)};
}

}  // namespace

std::optional<ScaleDoubt> doubt_of_scale(const WeighedObject& object) {
  const std::optional<Factor> factor = factor_of(object);
  if (!factor) return std::nullopt;
  const double doubted_log = std::copysign(doubted(factor->log, factor->std), factor->log);
  if (doubted_log == 0.0) return std::nullopt;
  return ScaleDoubt{std::exp(factor->log), std::exp(doubted_log)};
}

ScaleFindings check_force_scale(std::span<const WeighedObject> objects) {
  ScaleFindings findings;
  for (const WeighedObject& object : objects) {
    findings.fault = force_unit_fault(object.name, object.weighed_mass, object.mass);
    if (findings.fault) return findings;
  }
  const std::vector<Factor> factors = factors_of(objects);
  if (factors.empty()) {
    findings.notes.push_back(std::string("the force's scale is not compared with a mass: ") +
                             (objects.empty() ? "no object was weighed; "
                                              : "no push excited that of a weighed object; ") +
                             kForceScaleEffect);
  }
  if (const std::optional<CommonFactor> common = common_factor(factors)) {
    std::string message = fmt::format(
        "the force is {:.3g} +- {:.2g} times what it must be:", common->value, common->std);
    for (const Factor& one : factors) {
      message += (&one == &factors.front() ? " " : "; ") + masses_text(*one.object);
    }
    findings.fault = InputFault{
        InputFaultKind::force_unit,
        {.message = std::move(message),
         .file = "wrench.csv",
         .hint = "check the sensor's unit, range and calibration, or correct all masses"}};
    return findings;
  }
  for (const Factor& one : factors) {
    if (!is_contradiction(one)) continue;
    findings.warnings.push_back(
        masses_text(*one.object) +
        fmt::format(": the given mass or the force is wrong, by a factor of {:.3g} +- {:.2g}; the "
                    "given mass is kept, and what is identified from the force may be off by that "
                    "factor, which its stds contain: weigh the object again, and check the "
                    "sensor's calibration",
                    std::exp(one.log), std::exp(one.log) * one.std));
  }
  return findings;
}

}  // namespace pcavr
