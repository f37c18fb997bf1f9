// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/plan_motion.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/median.hpp"

#include "plan_contacts.hpp"

namespace pcavr {
namespace {

// Values for the case that nothing is known from which a number could be computed.
constexpr int kFirstBreakaways = 4;
constexpr int kFirstSlides = 2;
constexpr double kFirstPressDepth = 0.002;   // [m] of something whose stiffness is not known
constexpr double kGuessedTipNoise = 5e-5;    // [m] one sample of a robot's forward kinematics
constexpr double kGuessedSampleTime = 0.04;  // [s] between independent samples of a slide

PlannedStd std_row(const char* name, const char* unit, const std::optional<ParameterValue>& known,
                   bool is_identified, double wished_share) {
  PlannedStd row{.name = name, .unit = unit};
  if (known && is_identified) row.now = known->std;
  if (known) row.wished = wished_share * std::abs(known->value);
  return row;
}

bool is_reached(const PlannedStd& row) { return row.now && row.wished && *row.now <= *row.wished; }

PressNoise press_noise(const IdentificationInput& input, const Identification& found) {
  std::vector<double> tip;
  for (const Contact& contact : found.contacts) {
    if (contact.tool_noise) tip.push_back(*contact.tool_noise);
  }
  return {mean_interval(input.t_force), found.inputs.force_noise,
          tip.empty() ? kGuessedTipNoise : median(tip)};
}

void plan_contact_law(const PlannedObject& known, const PressNoise& noise,
                      const IdentificationOptions& options, ObjectPlan& plan) {
  const ObjectParameters& p = known.found.parameters;
  const bool is_identified =
      !known.found.is_exponent_given && p.contact_exponent && p.contact_exponent->std.has_value();
  PlannedStd exponent = std_row("contact.exponent", "", p.contact_exponent, is_identified, 0.0);
  exponent.wished = options.plan.exponent_std;
  const std::optional<HuntCrossley> law = contact_law_of(p);
  const bool is_linear = law && law->exponent == 1.0;
  PlannedStd damping =
      std_row("contact.damping", is_linear ? "N s/m" : "N s/m^(n+1)", p.contact_damping,
              p.contact_damping.has_value(), options.plan.damping_std);
  plan.press_depth = std::min(options.plan.press_depth, kFirstPressDepth);
  if (!is_reached(exponent) || !is_reached(damping)) {
    plan.press_series = 1;
    if (law) {
      const PressPlan presses = plan_presses(*law, noise, options.contact_fit, options.plan);
      plan.press_series = presses.series;
      plan.press_depth = presses.depth;
      plan.is_enough = plan.is_enough && presses.is_enough;
      exponent.expected = presses.expected.exponent.std;
      if (law->damping > 0.0 && presses.expected.damping.is_excited) {
        damping.expected = presses.expected.damping.std;
      }
    }
  }
  plan.stds.push_back(exponent);
  plan.stds.push_back(damping);
}

SlideNoise slide_noise(const std::vector<FrictionSample>& samples) {
  std::vector<double> intervals, force, speed, acceleration;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    force.push_back(samples[i].force_std);
    speed.push_back(samples[i].speed_std);
    acceleration.push_back(samples[i].acceleration_std);
    if (i > 0 && samples[i].push == samples[i - 1].push) {
      intervals.push_back(samples[i].t - samples[i - 1].t);
    }
  }
  return {intervals.empty() ? kGuessedSampleTime : median(intervals), median(force), median(speed),
          median(acceleration)};
}

void plan_sliding(const PlannedObject& known, const IdentificationOptions& options,
                  ObjectPlan& plan) {
  const ObjectIdentification& found = known.found;
  const ObjectParameters& p = found.parameters;
  const FrictionPosterior& now = found.friction;
  const PlanOptions& wished = options.plan;
  PlannedStd mass = std_row("mass", "kg", p.mass, now.mass.is_excited, wished.mass_std);
  PlannedStd coefficient =
      std_row("sliding_friction_coefficient", "", p.sliding_friction_coefficient,
              now.coefficient.is_excited, wished.coefficient_std);
  PlannedStd viscous = std_row("viscous_friction", "N s/m", p.viscous_friction,
                               now.viscous.is_excited, wished.viscous_std);
  plan.slides = kFirstSlides;
  if (now.is_valid) {
    FrictionPriors priors = options.friction_priors;
    priors.gravity = options.sliding.gravity;
    if (found.is_mass_given) priors.mass = p.mass->value;
    const SlidePlan slides = plan_slides(now, slide_noise(found.slide_samples), priors, wished);
    plan.slides = slides.slides;
    mass.expected = slides.expected.mass.std;
    viscous.expected = slides.expected.viscous.std;
    viscous.wished = wished.viscous_std * std::abs(slides.expected.viscous.value);
    if (slides.expected.coefficient.is_excited) {
      coefficient.expected = slides.expected.coefficient.std;
      coefficient.wished = wished.coefficient_std * slides.expected.coefficient.value;
    }
    const bool is_reached_now =
        (found.is_mass_given || is_reached(mass)) && is_reached(coefficient) && is_reached(viscous);
    if (is_reached_now) plan.slides = 0;
    plan.is_enough = plan.is_enough && (is_reached_now || slides.is_enough);
  }
  if (!found.is_mass_given) plan.stds.push_back(mass);
  plan.stds.push_back(coefficient);
  plan.stds.push_back(viscous);
}

/// [N] of F_M by one push: the precise ones count most, as the planned pushes are slow and centred.
double push_std_of(const std::vector<const Contact*>& contacts) {
  double information = 0.0, count = 0.0;
  for (const Contact* contact : contacts) {
    if (!contact->limit.is_excited || !(contact->limit.std > 0.0)) continue;
    // Nearly all of a fast push's std is shared: it says little of slow ones.
    information += std::pow(std::hypot(contact->limit.std, contact->limit_shared_std), -2);
    ++count;
  }
  return information > 0.0 ? std::sqrt(count / information) : 0.0;
}

void plan_breakaways(const PlannedObject& known, const IdentificationOptions& options,
                     ObjectPlan& plan) {
  const ObjectIdentification& found = known.found;
  PlannedStd limit =
      std_row("limiting_static_friction", "N", found.parameters.limiting_static_friction,
              found.limit.pushes > 0, options.plan.limit_std);
  int pushes = kFirstBreakaways;
  if (found.limit.pushes > 0) {
    const double common =
        limit_rate_std(found.limit_of_pushes.limit.value, kLoadingTime, options.breakaway_priors);
    const LimitPlan planned = plan_limits(found.limit_of_pushes, push_std_of(known.contacts),
                                          common, options.friction_priors, options.plan);
    pushes = is_reached(limit) ? 0 : planned.pushes;
    plan.is_enough = plan.is_enough && (is_reached(limit) || planned.is_enough);
    limit.expected = planned.expected_std;
  }
  plan.breakaways = std::max(0, pushes - plan.slides);  // each slide begins with one
  plan.stds.push_back(limit);
}

Pose last_pose(const IdentifiableObject& object) {
  return object.tracked.empty() ? object.T_base_object : object.tracked.back().T_base_object;
}

void note_what_is_left(const PlannedObject& known, IdentificationGoal goal, ObjectPlan& plan) {
  if (!plan.is_enough) {
    plan.notes.emplace_back(
        "not all wished stds are reached: raise identification.plan.max_contacts or max_speed");
  }
  if (!known.object.is_movable || goal != IdentificationGoal::friction) return;
  if (!known.found.friction_radius) {
    plan.notes.emplace_back(
        "friction_radius is not part of it: push off-centre, on two faces and in both directions "
        "of rotation, with tracking");
  }
  if (known.object.tracked.empty() && !plan.is_empty()) {
    plan.notes.emplace_back("put the object where this recording began: its pose is not tracked");
  }
}

}  // namespace

MotionPlan plan_motion(const IdentificationInput& input, const Identification& found,
                       const IdentificationOptions& options) {
  MotionPlan plan;
  double top = 0.0;
  for (const IdentifiableObject& object : input.objects) {
    top = std::max(top, extents_of(object.model, last_pose(object)).max().z());
  }
  PlanPath path(input.tool_radius, top + input.tool_radius + options.plan.clearance);
  const PressNoise noise = press_noise(input, found);
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    PlannedObject known{input.objects[i], found.objects[i], {}};
    for (const Contact& contact : found.contacts) {
      if (contact.object == i && contact.left_out.empty()) known.contacts.push_back(&contact);
    }
    ObjectPlan& one = plan.objects.emplace_back();
    one.name = known.object.name;
    one.slide = planned_slide(options.plan);
    plan_contact_law(known, noise, options, one);
    const bool is_pushed = found.goal == IdentificationGoal::friction && known.object.is_movable;
    if (is_pushed) {
      plan_sliding(known, options, one);
      plan_breakaways(known, options, one);
    }
    const Pose T_base_object = last_pose(known.object);
    if (one.press_series > 0) append_presses(known, T_base_object, one, path);
    if (is_pushed) {
      append_pushes(known, T_base_object, input.tool_radius, options.plan.arm_stiffness, one, path);
    }
    note_what_is_left(known, found.goal, one);
  }
  plan.path = path.take();
  return plan;
}

}  // namespace pcavr
