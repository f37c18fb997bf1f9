// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/known_before.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr double kSameShare = 0.2;  // of a std, and of two stds' difference in the larger one

bool is_same(const HuntCrossley& a, const HuntCrossley& b) {
  return a.stiffness == b.stiffness && a.damping == b.damping && a.exponent == b.exponent;
}

bool is_same_std(double a, double b) { return std::abs(a - b) <= kSameShare * std::max(a, b); }

}  // namespace

bool is_unchanged(const PushEvidence::Slide& shown, const ContactCompliance& compliance,
                  const KnownSupport& support) {
  const ContactCompliance& before = shown.compliance;
  if (before.law.has_value() != compliance.law.has_value()) return false;
  if (before.law && !is_same(*before.law, *compliance.law)) return false;
  return is_same_std(before.std, compliance.std) &&
         is_same_std(before.damping_std, compliance.damping_std) &&
         shown.support.friction_radius == support.friction_radius &&
         shown.support.weight == support.weight;
}

bool is_unchanged(const PushedObject& shown, const PushedObject& object) {
  const Eigen::Vector2d stds = object.sliding_covariance.diagonal().cwiseSqrt();
  const Eigen::Vector2d stds_before = shown.sliding_covariance.diagonal().cwiseSqrt();
  for (int k = 0; k < 2; ++k) {
    if (!is_same_std(stds_before[k], stds[k])) return false;
    if (std::abs(shown.sliding[k] - object.sliding[k]) > kSameShare * stds[k]) return false;
  }
  const double correlation = object.sliding_covariance(0, 1) / stds.prod();
  const double correlation_before = shown.sliding_covariance(0, 1) / stds_before.prod();
  return std::abs(correlation - correlation_before) <= kSameShare &&
         is_same(shown.contact_law, object.contact_law) &&
         is_same_std(shown.compliance_std, object.compliance_std) &&
         is_same_std(shown.damping_std, object.damping_std) &&
         std::abs(shown.mass - object.mass) <= kSameShare * object.mass_std * object.mass &&
         is_same_std(shown.mass_std, object.mass_std) &&
         shown.stribeck_speed == object.stribeck_speed;
}

}  // namespace pcavr
