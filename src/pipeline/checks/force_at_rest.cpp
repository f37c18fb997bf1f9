// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "force_at_rest.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/segmentation.hpp"

#include "input_comparisons.hpp"

namespace pcavr {
namespace {

constexpr char kWhat[] = "force at rest";
constexpr char kInput[] = "wrench.csv: force at rest";
constexpr double kMaxBias = 1.0;        // [N] from which `identify` takes it off with a warning
constexpr double kMinWeightPart = 0.7;  // of the bias along z, from which a weight explains it

struct RestingForce {
  Eigen::Vector3d level = Eigen::Vector3d::Zero();  ///< [N] median by axis
  double drift = 0.0;                               ///< [N] farthest from the level
};

RestingForce resting_force(const std::vector<Eigen::Vector3d>& bias_base) {
  RestingForce found;
  for (int axis = 0; axis < 3; ++axis) found.level[axis] = median(axis_of(bias_base, axis));
  for (const Eigen::Vector3d& bias : bias_base) {
    found.drift = std::max(found.drift, (bias - found.level).norm());
  }
  return found;
}

std::string figure_of(const RestingForce& found, double noise) {
  return fmt::format(
      "{:.2f} N without contact (x {:.2f}, y {:.2f}, z {:.2f}), drifting by {:.2f} N; noise {:.2f} "
      "N",
      found.level.norm(), found.level.x(), found.level.y(), found.level.z(), found.drift, noise);
}

/// What would explain the level.
std::string cause_of(const RestingForce& found) {
  const double vertical = std::abs(found.level.z());
  const std::string zero = "set the sensor to zero before recording, or import with --tare";
  if (vertical < kMinWeightPart * found.level.norm()) {
    return "a bias: no weight points that way; " + zero;
  }
  return fmt::format("the weight of a tool of {:.2f} kg, or a bias; {}",
                     vertical / kStandardGravity, zero);
}

}  // namespace

InputComparison compare_force_at_rest(const IdentificationInput& input,
                                      std::vector<ConsistencyFinding>& findings) {
  const Segmentation found =
      segment_contacts(input.t_force, input.force_base, input.t_tool, input.p_base_tip);
  if (found.bias_base.empty()) return failed_comparison(kWhat, "the tool is never free of contact");
  const RestingForce resting = resting_force(found.bias_base);
  std::string figure = figure_of(resting, found.noise);
  if (resting.level.norm() >= kMaxBias) {
    findings.push_back(
        {.file = "wrench.csv", .place = kInput, .message = figure, .hint = cause_of(resting)});
  }
  return comparison_of(kWhat, std::move(figure), {kInput});
}

}  // namespace pcavr
