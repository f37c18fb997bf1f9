// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/contact/contact_law.hpp"
#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/contact/impact.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/object/damping_choice.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

/// Exponent of a spherical tip on a flat face [Hertz 1882]: assumed where no press gives it, with
/// the std of a uniform distribution between 1 (a flat tip, a layer) and 2 (a cone).
constexpr double kHertzExponent = 1.5;
constexpr double kHertzExponentStd = 0.289;  // 1 / sqrt(12)
/// Std of a stiffness over its value above which the pulse's width does not identify it.
constexpr double kMaxStiffnessShare = 0.5;
/// Stiffnesses of presses and of impacts contradict each other from here on.
constexpr double kContradictionStds = 4.0;

/// Relative std; infinite where there is no value.
double share_of(const ParameterValue& value) {
  return value.std && value.value > 0.0 ? *value.std / value.value : HUGE_VAL;
}

/// The law's factor g(c) and its std by the restitution's.
IdentifiedParameter factor_of(DampingLaw law, const IdentifiedParameter& restitution) {
  const auto at = [law](double c) { return damping_factor(law, std::clamp(c, 1e-3, 1.0)); };
  const double c = restitution.value;
  const double slope = 0.5 * std::abs(at(c - restitution.std) - at(c + restitution.std));
  return {at(c), slope, true};
}

/// lambda / k by a damping law.
IdentifiedParameter damping_over_stiffness(DampingLaw law, const MeasuredImpact& impact) {
  const IdentifiedParameter factor = factor_of(law, impact.restitution);
  const double value = factor.value / impact.approach_speed.value;
  const double speed_share = impact.approach_speed.std / impact.approach_speed.value;
  return {value, std::hypot(factor.std / impact.approach_speed.value, value * speed_share), true};
}

/// Probability that the sensor averages over its interval, as a filter does, and does not sample:
/// samples of a pulse that is hardly wider than the interval give another impulse, and so another
/// mass of the tool, at each phase. It follows from the likelihoods of the masses' scatter; a half
/// where the impacts do not show it.
double averaging_probability(const std::vector<const ImpactMotion*>& motions) {
  constexpr std::size_t kMinImpacts = 3;
  constexpr double kMinScatter = 0.01;  // of the masses: the tool is not quite rigid
  if (motions.size() < kMinImpacts) return 0.5;
  std::vector<double> logs, shares, ratios, deviations;
  for (const ImpactMotion* motion : motions) {
    logs.push_back(std::log(motion->mass.value));
    shares.push_back(motion->mass.std / motion->mass.value);
    ratios.push_back(motion->width / (motion->sample_width * std::sqrt(12.0)));
  }
  const double middle = median(logs);
  for (const double value : logs) deviations.push_back(kStdOverMad * std::abs(value - middle));
  const double scatter = median(std::move(deviations));
  const double averaged = std::max(kMinScatter, median(std::move(shares)));
  // The first alias of a Gaussian pulse of that width, at an unknown phase.
  const double phase = std::numbers::pi * median(std::move(ratios));
  const double sampled = std::hypot(averaged, std::numbers::sqrt2 * std::exp(-2.0 * phase * phase));
  const double freedom = static_cast<double>(motions.size() - 1);
  const double gain =
      freedom * (std::log(sampled / averaged) -
                 0.5 * scatter * scatter * (std::pow(averaged, -2) - std::pow(sampled, -2)));
  return 1.0 / (1.0 + std::exp(-gain));
}

/// The part of a pulse's squared width [s^2] that the sensor adds, and its std, the same in all
/// impacts: no sensor averages over exactly its interval.
struct SensorWidth {
  double square = 0.0, std = 0.0;
};

SensorWidth sensor_width(const std::vector<const ImpactMotion*>& motions) {
  constexpr double kMinStd = 0.1;  // of the square
  if (motions.empty()) return {};
  const double p = averaging_probability(motions);
  const double sampled = std::pow(motions.front()->sample_width, 2);
  return {p * sampled, std::hypot(kMinStd, std::sqrt(p * (1.0 - p))) * sampled};
}

/// k from the width w of the pulse: in units of L = (m v^2 / k)^(1/(n+1)) and L / v, the pulse
/// depends on restitution and exponent only. The std is that of its own noise.
IdentifiedParameter stiffness_of(const ImpactMotion& motion, double sensor_square,
                                 double restitution, double exponent) {
  const double square = std::pow(motion.width, 2) - sensor_square;
  if (!(square > 0.0)) return {};
  const double width = std::sqrt(square);
  const double width_std = motion.width * motion.width_std / width;
  const Impact unit =
      simulate_impact(HuntCrossley{1.0, exact_damping_factor(restitution), exponent}, 1.0, 1.0);
  if (!(unit.force_width > 0.0)) return {};
  const double speed = motion.approach.value;
  const double length = speed * width / unit.force_width;
  const double value = motion.mass.value * speed * speed / std::pow(length, exponent + 1.0);
  const double share =
      std::hypot((exponent + 1.0) * width_std / width, motion.mass.std / motion.mass.value);
  return {value, value * share, share < kMaxStiffnessShare};
}

/// Speed of the object after a push, from the impulse less that of friction [m/s]; empty where the
/// mass is not known.
std::optional<double> object_speed(const Contact& contact, const ObjectParameters& known) {
  if (!known.mass) return std::nullopt;
  double impulse = contact.impact->impulse;
  const double duration = contact.end - contact.begin;
  const auto& limit = known.limiting_static_friction;
  if (limit) impulse -= std::min(impulse, limit->value * duration);
  return impulse / known.mass->value;
}

/// The restitution of an impact [paper B, eq. 11]. Empty where the object's own speed is not known.
std::optional<IdentifiedParameter> restitution_of(const Contact& contact, bool is_fixed,
                                                  const ObjectParameters& known) {
  const ImpactMotion& motion = *contact.impact;
  if (is_fixed) return motion.speed_ratio;
  const std::optional<double> speed = object_speed(contact, known);
  if (!speed) return std::nullopt;
  const Eigen::Vector3d along = Eigen::Vector3d::UnitX();
  const auto ratio = measured_restitution({.normal = along,
                                           .tool_before = motion.approach.value * along,
                                           .tool_after = -motion.separation.value * along,
                                           .body_after = *speed * along});
  if (!ratio) return std::nullopt;
  return IdentifiedParameter{*ratio, motion.speed_ratio.std, true};
}

MeasuredImpact measure(const Contact& contact, const IdentifiedParameter& restitution) {
  MeasuredImpact impact{.t = contact.begin,
                        .duration = contact.end - contact.begin,
                        .approach_speed = contact.impact->approach,
                        .restitution = restitution,
                        .mass = contact.impact->mass,
                        .law = best_published_damping_law(restitution.value).law};
  impact.damping_over_stiffness = damping_over_stiffness(DampingLaw::exact, impact);
  return impact;
}

/// Mean weighted by the inverse variances; its std grows with a scatter beyond them (Birge ratio).
template <typename Value>
IdentifiedParameter weighted_mean(const std::vector<MeasuredImpact>& impacts, const Value& value) {
  double weights = 0.0, sum = 0.0, chi_squared = 0.0, count = 0.0;
  std::vector<IdentifiedParameter> used;
  for (const MeasuredImpact& impact : impacts) {
    const IdentifiedParameter one = value(impact);
    if (one.is_excited && one.std > 0.0) used.push_back(one);
  }
  if (used.empty()) return {};
  for (const IdentifiedParameter& one : used) {
    weights += 1.0 / (one.std * one.std);
    sum += one.value / (one.std * one.std);
    count += 1.0;
  }
  const double mean = sum / weights;
  for (const IdentifiedParameter& one : used) {
    chi_squared += std::pow((one.value - mean) / one.std, 2);
  }
  const double birge = count > 1.0 ? std::sqrt(chi_squared / (count - 1.0)) : 1.0;
  return {mean, std::max(1.0, birge) / std::sqrt(weights), true};
}

/// Median of the stiffnesses, with the larger of its own std and the scatter's. Not a mean: a spike
/// of the force beside a pulse widens it, which lowers its stiffness and, by more, its std.
IdentifiedParameter median_stiffness(const std::vector<MeasuredImpact>& impacts) {
  std::vector<double> logs, shares, deviations;
  for (const MeasuredImpact& impact : impacts) {
    const IdentifiedParameter& one = impact.stiffness;
    if (!one.is_excited || !(one.value > 0.0)) continue;
    logs.push_back(std::log(one.value));
    shares.push_back(one.std / one.value);
  }
  if (logs.empty()) return {};
  const double middle = median(logs);
  for (const double value : logs) deviations.push_back(kStdOverMad * std::abs(value - middle));
  const double share = std::max(median(std::move(shares)), median(std::move(deviations))) /
                       std::sqrt(static_cast<double>(logs.size()));
  return {std::exp(middle), std::exp(middle) * share, true};
}

/// Relative std of the stiffness by an uncertain exponent: the pulses' width then fixes another k.
double exponent_share(const std::vector<const ImpactMotion*>& motions, double sensor_square,
                      std::vector<MeasuredImpact> impacts, const ParameterValue& exponent) {
  double logs[2] = {0.0, 0.0}, exponents[2] = {0.0, 0.0};
  for (const int side : {0, 1}) {
    exponents[side] = std::max(1.0, exponent.value + (2 * side - 1) * *exponent.std);
    for (std::size_t i = 0; i < impacts.size(); ++i) {
      impacts[i].stiffness =
          stiffness_of(*motions[i], sensor_square, impacts[i].restitution.value, exponents[side]);
    }
    const IdentifiedParameter found = median_stiffness(impacts);
    if (!found.is_excited) return HUGE_VAL;
    logs[side] = std::log(found.value);
  }
  return std::abs(logs[1] - logs[0]) / (exponents[1] - exponents[0]) * *exponent.std;
}

/// The impacts' stiffness for the exponent, with what the sensor's own width makes uncertain in all
/// of them alike; and its std with the exponent's share.
void find_stiffness(const std::vector<const ImpactMotion*>& motions, const ParameterValue& exponent,
                    ObjectIdentification& result) {
  const SensorWidth sensor = sensor_width(motions);
  std::vector<double> squares;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    MeasuredImpact& impact = result.impacts[i];
    impact.stiffness =
        stiffness_of(*motions[i], sensor.square, impact.restitution.value, exponent.value);
    squares.push_back(std::pow(motions[i]->width, 2) - sensor.square);
  }
  ImpactFindings& found = result.impact_findings;
  found.exponent = exponent.value;
  found.stiffness = median_stiffness(result.impacts);
  if (!found.stiffness.is_excited) return;
  const double common = 0.5 * (exponent.value + 1.0) * sensor.std / median(std::move(squares));
  const double share = std::hypot(found.stiffness.std / found.stiffness.value, common);
  found.stiffness.std = share * found.stiffness.value;
  found.stiffness_std =
      found.stiffness.value *
      std::hypot(share, exponent_share(motions, sensor.square, result.impacts, exponent));
}

/// Whether the impacts' stiffness replaces the known one: where presses, which hardly penetrate a
/// stiff contact, gave none, a linear law whose exponent they do not know, or one that contradicts
/// the impacts.
bool is_stiffness_needed(const ObjectIdentification& result, bool has_press) {
  const IdentifiedParameter& found = result.impact_findings.stiffness;
  const auto& known = result.parameters.contact_stiffness;
  if (!found.is_excited) return false;
  if (!known) return true;
  const double share = share_of(as_value(found));
  if (!has_press) return share < share_of(*known);
  const IdentifiedParameter& exponent = result.presses.best().exponent;
  // Linear: the stiffness is of another unit, so they can't be compared.
  if (exponent.value <= 1.0) return exponent.std > kHertzExponentStd;
  const double gap = std::abs(std::log(found.value / known->value));
  return gap > kContradictionStds * std::hypot(share, share_of(*known));
}

void take_stiffness(ObjectIdentification& result) {
  ImpactFindings& found = result.impact_findings;
  ObjectParameters& parameters = result.parameters;
  found.gives_stiffness = true;
  // The stiffness is assumed if the exponent is: it is right about the pulses only.
  const bool is_identified = found.stiffness_std < kMaxStiffnessShare * found.stiffness.value;
  parameters.contact_stiffness = ParameterValue{found.stiffness.value, {}};
  if (is_identified) parameters.contact_stiffness->std = found.stiffness_std;
  parameters.contact_exponent = ParameterValue{found.exponent, {}};
  result.penetration = {};
  result.comparison.clear();  // of estimators, under the presses' law
  parameters.contact_mass.reset();
  // The damping of the presses belongs to their stiffness and exponent.
  parameters.contact_damping.reset();
  parameters.contact_damping_law.reset();
  result.is_exponent_given = true;
  for (auto* counts : {&parameters.sources.presses, &parameters.sources.pushes}) {
    counts->erase("contact.damping");
    counts->erase("contact.stiffness");
    counts->erase("contact.exponent");
    counts->erase("contact.mass");
  }
  if (is_identified) {
    parameters.sources.impacts["contact.stiffness"] = static_cast<int>(result.impacts.size());
  }
}

void take_damping(ObjectIdentification& result, std::optional<DampingLaw> option) {
  ImpactFindings& found = result.impact_findings;
  ObjectParameters& parameters = result.parameters;
  const ChosenDampingLaw chosen = choose_damping_law(option, found.restitution.value);
  const DampingLaw law = chosen.law;
  found.law = law;
  found.choice = chosen.reason;
  found.damping_over_stiffness = weighted_mean(
      result.impacts, [law](const auto& impact) { return damping_over_stiffness(law, impact); });
  const auto leave_out = [&](std::string_view reason) {
    result.notes.push_back(
        fmt::format("the damping law {} of impacts is not used: {}", key_of(law), reason));
  };
  if (!parameters.contact_stiffness) return leave_out("no stiffness is known");
  if (parameters.contact_exponent.value_or(ParameterValue{1.0}).value <= 1.0) {
    return leave_out("the contact is linear");  // Kelvin-Voigt has another relation
  }
  const ParameterValue& stiffness = *parameters.contact_stiffness;
  const double value = found.damping_over_stiffness.value * stiffness.value;
  const double share =
      std::hypot(found.damping_over_stiffness.std / found.damping_over_stiffness.value,
                 stiffness.std ? *stiffness.std / stiffness.value : 0.0);
  ParameterValue damping{value, value * share};
  // Its unit is that of an assumed exponent, too.
  if (!stiffness.std) damping.std.reset();
  if (parameters.contact_damping && share_of(*parameters.contact_damping) < share) {
    return leave_out("the damping of presses is more certain");
  }
  parameters.contact_damping = damping;
  parameters.contact_damping_law = law;
  found.gives_damping = true;
  const auto count = static_cast<int>(result.impacts.size());
  for (auto* counts : {&parameters.sources.presses, &parameters.sources.pushes}) {
    counts->erase("contact.damping");
  }
  if (damping.std) parameters.sources.impacts["contact.damping"] = count;
}

}  // namespace

void identify_impacts(const std::vector<Contact>& contacts, std::size_t object,
                      std::optional<DampingLaw> damping_law, ObjectIdentification& result) {
  const ContactFit& press = result.presses.best();
  const bool has_press = press.is_valid && press.stiffness.is_excited;
  const bool is_curved = has_press && press.exponent.value > 1.0;
  const ParameterValue exponent =
      is_curved ? as_value(press.exponent) : ParameterValue{kHertzExponent, kHertzExponentStd};
  std::vector<const ImpactMotion*> motions;
  for (const Contact& contact : contacts) {
    if (contact.object != object || !contact.left_out.empty() || !contact.impact) continue;
    const bool is_fixed = !result.is_movable || contact.kind == ContactKind::press;
    const auto restitution = restitution_of(contact, is_fixed, result.parameters);
    if (!restitution) {
      result.notes.push_back("the impact at " + at_time(contact.begin) +
                             " is not used: the object moves, and its mass is not known");
    } else if (!(restitution->value > 0.0 && restitution->value < 1.0)) {
      result.notes.push_back(fmt::format(
          "the impact at {} is not used: a restitution of {:.2f} +- {:.2f} is not physical",
          at_time(contact.begin), restitution->value, restitution->std));
    } else {
      result.impacts.push_back(measure(contact, *restitution));
      motions.push_back(&*contact.impact);
    }
  }
  if (result.impacts.empty()) return;
  ImpactFindings& found = result.impact_findings;
  found.restitution =
      weighted_mean(result.impacts, [](const auto& impact) { return impact.restitution; });
  find_stiffness(motions, exponent, result);
  result.parameters.contact_restitution = as_value(found.restitution);
  result.parameters.contact_impact_speed = as_value(
      weighted_mean(result.impacts, [](const auto& impact) { return impact.approach_speed; }));
  for (const char* key : {"contact.restitution", "contact.impact_speed"}) {
    result.parameters.sources.impacts[key] = static_cast<int>(result.impacts.size());
  }
  if (is_stiffness_needed(result, has_press)) take_stiffness(result);
  take_damping(result, damping_law);
}

}  // namespace pcavr
