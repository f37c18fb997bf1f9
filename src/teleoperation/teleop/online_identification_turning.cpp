// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification of what tracking shows: how the object turns, and how the tip slips.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/turning/support.hpp"
#include "pcavr/physics/turning/tool_friction.hpp"

#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {
namespace {

// Contacts whose samples are kept: a limit surface needs dozens of pushes.
constexpr std::size_t kMaxSeenContacts = 40;
// Number of contacts up to which one that is not over yet changes the estimate by more than a
// tenth.
constexpr std::size_t kFewContacts = 10;
// Pushes that turned the object, for a radius: the std is by leaving one out.
constexpr std::size_t kMinTurningPushes = 3;
// Stds within which the radius of few pushes is that of even pressure, which the prediction has.
constexpr double kSameRadius = 2.0;

/// [N s/m] Uniform from 0 to what some push leaves no Coulomb friction beside, or to the prior's.
ParameterValue viscous_prior(const SamplesOfPushes& pushes) {
  double most = FrictionPriors().max_viscous;
  for (const PushSample& sample : joined(pushes)) {
    const double speed = sample.twist.head<2>().norm();
    if (speed > 0.0) most = std::min(most, sample.wrench.head<2>().norm() / speed);
  }
  return {0.5 * most, most / std::sqrt(12.0)};
}

}  // namespace

void OnlineIdentification::learn_turning(const ContactRecord& record,
                                         const IdentifiedContact& contact, bool is_over) {
  const ContactEpisode& episode = contact.episode;
  const ObjectMotion& seen = *record.seen;
  if (seen_samples_.empty() || std::abs(seen_samples_.back().begin - episode.begin) >= kSameContact)
    seen_samples_.emplace_back();
  if (seen_samples_.size() > kMaxSeenContacts) seen_samples_.pop_front();
  const PathView tip(record.t_tool, record.p_base_tip);
  std::optional<double> weight;
  if (known_.mass) weight = known_.mass->value * options_.sliding.gravity;
  seen_samples_.back() = {
      episode.begin, turning_samples(contact, seen.body, tip, seen.tool_radius, weight),
      tool_friction_samples(contact, seen.body, seen.surface, tip, seen.tool_radius)};
  learn_tool_friction(seen.body.tracked);
  if (is_over || seen_samples_.size() <= kFewContacts) learn_radius(seen.body);
}

void OnlineIdentification::learn_tool_friction(std::span<const TrackedPose> tracked) {
  std::vector<std::vector<double>> contacts;
  for (const SeenSamples& seen : seen_samples_) contacts.push_back(seen.tool_friction);
  if (const std::optional<ToolFriction> friction = tool_friction_of(contacts, tracked)) {
    accept(&ObjectParameters::tool_friction_coefficient, friction->coefficient);
  }
}

void OnlineIdentification::learn_radius(const BodyMotion& body) {
  SamplesOfPushes pushes;
  for (const SeenSamples& seen : seen_samples_) {
    if (!seen.turning.empty()) pushes.push_back(seen.turning);
  }
  if (pushes.size() < kMinTurningPushes) return;
  const ParameterValue viscous = known_.viscous_friction.value_or(viscous_prior(pushes));
  const TurningFriction turning = identify_turning(pushes, body, viscous, options_.limit_surface);
  const std::optional<ParameterValue>& radius = turning.radius;
  if (!radius || *radius->std > options_.max_radius_std * radius->value) return;
  const double even = Support(body.model, body.tracked.front().T_base_object).radius();
  if (std::abs(radius->value - even) <= kSameRadius * *radius->std) return;
  if (!accept(&ObjectParameters::friction_radius, *radius)) return;
  known_.limit_surface =
      turning.surface.status == LimitSurfaceFitStatus::fitted
          ? turning.surface.surface
          : surface_of_support(body.model, body.tracked.front().T_base_object, radius->value);
}

}  // namespace pcavr
