// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification of mass and friction from the pushes so far.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/inertial_peak.hpp"
#include "pcavr/physics/inputs/align_with_face.hpp"

#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {
namespace {

/// [Ns/m] The mean of the prior.
double expected_viscous(const FrictionPriors& priors) { return 0.5 * priors.max_viscous; }

/// Coulomb friction by a push's own slides: the median force along the push, less the viscous
/// share, of which only the prior is known. Its std has a tenth for inertia and for a force that
/// does not go through the centre; not excited without a slide.
IdentifiedParameter friction_in(const ContactEpisode& contact, const FrictionPriors& priors) {
  constexpr double kForceError = 0.1;
  constexpr double kMinPath = 5e-4;  // [m] of the tip: over less, the force still settles
  std::vector<double> forces;
  double path = 0.0, duration = 0.0;
  for (const SlideInterval& slide : contact.slides) {
    const auto from = std::lower_bound(contact.t.begin(), contact.t.end(), slide.begin);
    const auto to = std::upper_bound(from, contact.t.end(), slide.end);
    if (to - from < 2) continue;
    const auto first = static_cast<std::size_t>(from - contact.t.begin());
    const auto last = static_cast<std::size_t>(to - contact.t.begin()) - 1;
    path += contact.tool[last] - contact.tool[first];
    duration += contact.t[last] - contact.t[first];
    forces.insert(forces.end(), contact.force.begin() + static_cast<std::ptrdiff_t>(first),
                  contact.force.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  }
  if (path < kMinPath) return {};
  const double force = median(std::move(forces));
  const double viscous = priors.max_viscous * path / duration;
  const double coulomb = force - expected_viscous(priors) * path / duration;
  return {coulomb, std::hypot(kForceError * force, viscous / std::sqrt(12.0)), true};
}

/// Force under which the newest push slid, by its samples; at least one. Its scatter about other
/// pushes is no error of it: `model_error` allows for it.
SlidingForce force_of_newest(const std::vector<FrictionSample>& samples, double mass,
                             double support_size_share) {
  const std::size_t newest = samples.back().push;
  double count = 0.0, force = 0.0, squares = 0.0, speed = 0.0, rotation = 0.0;
  for (const FrictionSample& sample : samples) {
    if (sample.push != newest) continue;
    const double friction = sample.force - mass * sample.acceleration;
    count += 1.0, force += friction, squares += friction * friction;
    speed += sample.speed, rotation += sample.rotation_share;
  }
  force /= count;
  const double variance = std::max(squares / count - force * force, 0.0);
  // Windows of smoothing overlap: every other sample is independent.
  const double noise = std::sqrt(2.0 * variance / count);
  return {speed / count, force, std::hypot(noise, support_size_share * rotation / count * force)};
}

/// mu M g + B v [N] by known parameters; without mass, coefficient or viscous friction their share
/// is left out.
ParameterValue sliding_force(const ObjectParameters& known, double weight, double speed,
                             double default_std) {
  const ParameterValue mu = known.sliding_friction_coefficient.value_or(ParameterValue{});
  const ParameterValue viscous = known.viscous_friction.value_or(ParameterValue{});
  const double force = mu.value * weight + viscous.value * speed;
  // The two compensate each other's errors.
  const double std =
      std::max(mu.std.value_or(default_std * mu.value) * weight, viscous.std.value_or(0.0) * speed);
  return {force, std};
}

/// The contact law of presses as `pcavr identify` has it: also one that is too uncertain to be
/// felt, since the linear law which is felt meanwhile is far off beyond the presses' forces.
void take_law(const ContactIdentification& presses, FrictionSearch& search) {
  const ContactFit& law = presses.best();
  search.known.contact_stiffness = as_value(law.stiffness);
  search.known.contact_exponent = as_value(law.exponent);
  search.known.contact_damping = damping_of(law);
  const double peak = search.press_peaks.empty() ? 0.0 : std::ranges::max(search.press_peaks);
  search.penetration_std = std::hypot(law.penetration_std, curvature_std(presses, law, peak));
}

}  // namespace

void OnlineIdentification::check_limits(IdentifiedContact& push) {
  const IdentifiedParameter sliding = friction_in(push.episode, options_.friction_priors);
  const auto contradict = [&](double limit, double std) {
    if (limit_above_sliding({limit, std, true}, sliding).is_excited) return false;
    contradiction_ = fmt::format(
        "a breakaway at {:.2f} N is below the sliding friction, {:.2f} N: it is not used to "
        "identify",
        limit, sliding.value);
    return true;
  };
  if (!sliding.is_excited) return;
  const std::optional<ParameterValue>& learned = known_.limiting_static_friction;
  if (learned && contradict(learned->value, learned->std.value_or(0.0))) discard_learned_limit();
  // The load of a tip that slipped, or left and came again, before the object slides at all.
  Breakaway& breakaway = push.episode.breakaway;
  if (breakaway.is_found && contradict(breakaway.force, breakaway.std)) breakaway.is_found = false;
}

IdentifiedContact OnlineIdentification::attributed(const ContactRecord& record,
                                                   const Segmentation& found) const {
  IdentifiedContact contact;
  contact.episode = contacts_.back();
  contact.object = 0;
  const ContactEpisode& episode = contact.episode;
  const auto first =
      std::lower_bound(record.t_force.begin(), record.t_force.end(), episode.t.front());
  const auto begin = found.force_base.begin() + (first - record.t_force.begin());
  contact.force_base.assign(begin, begin + std::ssize(episode.t));
  if (!record.seen) return contact;
  const PathView tip(record.t_tool, record.p_base_tip);
  const Pose T_base_object = pose_at(record.seen->body.tracked, episode.begin);
  contact.normal_object =
      record.seen->surface.touch(T_base_object, tip.at(episode.begin), record.seen->tool_radius)
          .normal_object;
  std::vector<Eigen::Vector3d> directions_base;
  for (const FrictionSearch::Push& push : pushes_)
    directions_base.push_back(push.stored->contact.episode.direction_base);
  align_with_face(T_base_object, record.seen->body.model.centre_of_mass_object, tip,
                  directions_base, contact);
  return contact;
}

void OnlineIdentification::store_push(const ContactRecord& record, IdentifiedContact contact) {
  const double begin = contact.episode.begin;
  if (!pushes_.empty() &&
      std::abs(pushes_.back().stored->contact.episode.begin - begin) < kSameContact)
    pushes_.pop_back();
  if (std::ssize(pushes_) >= options_.max_fitted_contacts) pushes_.pop_front();
  auto push = std::make_shared<StoredPush>();
  push->contact = std::move(contact);
  // The tip's path begins at the end of the push before.
  const double from = pushes_.empty() ? -std::numeric_limits<double>::infinity()
                                      : pushes_.back().stored->t_tool.back();
  const auto first = std::upper_bound(record.t_tool.begin(), record.t_tool.end(), from);
  const auto skipped = first - record.t_tool.begin();
  push->t_tool.assign(first, record.t_tool.end());
  push->p_base_tip.assign(record.p_base_tip.begin() + skipped, record.p_base_tip.end());
  if (record.seen) {
    model_ = &record.seen->body.model;
    tool_radius_ = record.seen->tool_radius;
    const std::span<const TrackedPose> tracked = record.seen->body.tracked;
    std::copy_if(tracked.begin(), tracked.end(), std::back_inserter(push->tracked),
                 [from](const TrackedPose& pose) { return pose.t > from; });
  }
  if (push->t_tool.empty()) return;
  pushes_.push_back({std::move(push), nullptr});
  has_new_push_ = true;
}

void OnlineIdentification::assume_friction(const ContactEpisode& push) {
  const bool has_friction = known_.sliding_friction_coefficient && !is_friction_assumed_;
  if (!known_.mass || has_friction) return;
  const IdentifiedParameter coulomb = friction_in(push, options_.friction_priors);
  if (!coulomb.is_excited || !(coulomb.value > 0.0)) return;
  const double weight = known_.mass->value * options_.sliding.gravity;
  known_.sliding_friction_coefficient =
      ParameterValue{coulomb.value / weight, coulomb.std / weight};
  known_.viscous_friction = ParameterValue{expected_viscous(options_.friction_priors),
                                           options_.friction_priors.max_viscous / std::sqrt(12.0)};
  is_friction_assumed_ = has_changed_ = true;
  assume_limit(coulomb.value);
}

void OnlineIdentification::assume_limit(double coulomb) {
  if (known_.limiting_static_friction && !is_limit_assumed_) return;
  const double excess = options_.breakaway_priors.excess * coulomb;
  known_.limiting_static_friction = ParameterValue{coulomb + excess, excess};
  is_limit_assumed_ = has_changed_ = true;
}

std::optional<FrictionSearch> OnlineIdentification::next_search() {
  if (!has_new_push_) return std::nullopt;
  has_new_push_ = false;
  FrictionSearch search{.pushes = {pushes_.begin(), pushes_.end()},
                        .known = known_,
                        .presses = presses_,
                        .penetration_std = given_.contact_stiffness ? 0.0 : penetration_std_,
                        .model = model_,
                        .tool_radius = tool_radius_};
  for (const ContactEpisode& contact : contacts_) {
    if (is_press(contact)) search.press_peaks.push_back(contact.peak_force);
  }
  // A mass that was learned is identified again, with what the newest pushes add.
  search.known.mass = given_.mass;
  const bool is_by_presses = !given_.contact_stiffness && presses_.best().is_valid;
  if (is_by_presses) take_law(presses_, search);
  const bool is_by_pushes = !given_.contact_stiffness && !is_by_presses;
  if (is_by_pushes && search.known.contact_exponent) {
    // The law that predicts these pushes best, but creep biases its exponent and its damping.
    search.known.contact_exponent->std = kExponentStdOfPushes;
    search.known.contact_damping.reset();
  }
  search.options.onset = options_.onset;
  search.options.limiting_friction = options_.limiting_friction;
  search.options.sliding = options_.sliding;
  search.options.friction_priors = options_.friction_priors;
  search.options.breakaway_priors = options_.breakaway_priors;
  search.options.inputs.segmentation = options_.segmentation;
  return search;
}

bool OnlineIdentification::accept(const FrictionSearch::Findings& findings) {
  has_changed_ = false;
  for (const FrictionSearch::Push& searched : findings.pushes) {
    for (FrictionSearch::Push& push : pushes_) {
      if (push.stored == searched.stored) push.shown = searched.shown;
    }
  }
  const ObjectIdentification& found = findings.object;
  const std::optional<ParameterValue> mass_before = known_.mass;
  if (!found.is_mass_given && found.sliding.mass.is_excited) {
    accept(&ObjectParameters::mass, {found.sliding.mass.value, found.sliding.mass.std});
  }
  // The inertia of a fast push is still in its peak without the sliding friction.
  const ContactEpisode& newest = findings.pushes.back().stored->contact.episode;
  const bool is_inertial =
      !found.friction.is_valid &&
      is_inertial_peak(newest.breakaway, friction_in(newest, options_.friction_priors));
  if (!is_inertial) accept_limit(found);
  if (!accept_sliding(found)) keep_friction_force(mass_before);
  return has_changed_;
}

void OnlineIdentification::keep_friction_force(const std::optional<ParameterValue>& mass_before) {
  std::optional<ParameterValue>& coefficient = known_.sliding_friction_coefficient;
  if (!mass_before || !known_.mass || !coefficient) return;
  if (given_.sliding_friction_coefficient || known_.mass->value == mass_before->value) return;
  const double ratio = mass_before->value / known_.mass->value;
  coefficient->value *= ratio;
  if (coefficient->std) *coefficient->std *= ratio;
}

void OnlineIdentification::accept_limit(const ObjectIdentification& found) {
  const IdentifiedParameter& limit = found.limit_of_pushes.limit;
  if (!limit.is_excited) return;
  if (found.limit.pushes == 0) {
    contradiction_ = found.notes.back();
    return discard_learned_limit();
  }
  std::optional<ParameterValue>& known = known_.limiting_static_friction;
  const ParameterValue value{limit.value, limit.std};
  // An earlier value was found in these pushes, too, or is assumed: the scatter that later pushes
  // show may widen the std.
  const bool is_learned = known && !given_.limiting_static_friction;
  if (!is_learned && !accept(&ObjectParameters::limiting_static_friction, value)) return;
  known = value;
  is_limit_assumed_ = false;
  has_changed_ = true;
  known_.limiting_static_friction_scatter = found.parameters.limiting_static_friction_scatter;
  known_.loading_rate = found.parameters.loading_rate;
}

void OnlineIdentification::discard_learned_limit() {
  std::optional<ParameterValue>& limit = known_.limiting_static_friction;
  if (!limit || given_.limiting_static_friction) return;
  limit.reset();
  is_limit_assumed_ = false;
  has_changed_ = true;
}

bool OnlineIdentification::is_sliding_contradicted(const std::vector<FrictionSample>& samples,
                                                   double mass) const {
  const SlidingForce newest =
      force_of_newest(samples, mass, options_.friction_priors.support_size_share);
  const ParameterValue old = sliding_force(
      known_, known_.mass.value_or(ParameterValue{mass}).value * options_.sliding.gravity,
      newest.speed, options_.default_relative_std);
  return is_contradicted(old, {newest.force, newest.std});
}

bool OnlineIdentification::accept_sliding(const ObjectIdentification& found) {
  const std::vector<SlidingForce>& forces = found.friction.sliding_force;
  if (!found.friction.coefficient.is_excited || forces.empty()) return false;
  const ObjectParameters& next = found.parameters;
  if (!next.mass || !next.sliding_friction_coefficient || !next.viscous_friction) return false;
  const SlidingForce& middle = forces[forces.size() / 2];
  const double relative_std = middle.std / middle.force;
  if (known_.sliding_friction_coefficient && !is_friction_assumed_) {
    const bool was_given = given_.sliding_friction_coefficient.has_value();
    const bool is_more_certain = !was_given && relative_std <= kMaxStdRatio * sliding_force_std_;
    if (!is_more_certain && !is_sliding_contradicted(found.slide_samples, next.mass->value)) {
      return false;
    }
  }
  known_.sliding_friction_coefficient = next.sliding_friction_coefficient;
  known_.viscous_friction = next.viscous_friction;
  given_.sliding_friction_coefficient.reset();
  given_.viscous_friction.reset();
  sliding_force_std_ = relative_std;
  is_friction_assumed_ = false;
  has_changed_ = true;
  assume_limit(next.sliding_friction_coefficient->value * next.mass->value *
               options_.sliding.gravity);
  return true;
}

}  // namespace pcavr
