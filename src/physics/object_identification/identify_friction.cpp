// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "physics/object_identification/breakaway_lever.hpp"
#include "physics/object_identification/identify_limits.hpp"
#include "physics/object_identification/identify_slides.hpp"

namespace pcavr {
namespace {

/// Stds beyond which a mass known before contradicts the one that accelerations show, and is
/// identified again. A weighed one is kept: a force of another scale would contradict it, too.
constexpr double kMassContradiction = 5.0;

/// Relative std of the compliance d / (n F) of a contact under `force`, by d = (F / k)^(1/n):
/// beyond the forces of the presses, d follows from the exponent.
double compliance_std(const ObjectIdentification& object, double pressed, double force,
                      const BreakawayPriors& priors) {
  const ObjectParameters& known = object.parameters;
  if (!known.contact_stiffness) return priors.compliance_std;
  const ParameterValue exponent = known.contact_exponent.value_or(ParameterValue{1.0, {}});
  const double n = exponent.value;
  const double stiffness_std = known.contact_stiffness->std.value_or(0.0);
  const double found_std = object.penetration.relative_std;
  const double penetration_std =
      found_std > 0.0 ? found_std : stiffness_std / (n * known.contact_stiffness->value);
  const double beyond = pressed > 0.0 ? std::max(0.0, std::log(force / pressed)) : 0.0;
  return std::hypot(penetration_std, exponent.std.value_or(0.0) / n * (1.0 + beyond / n));
}

/// [s/m] Std of the contact's damping over its stiffness.
double damping_std(const ObjectIdentification& object, const BreakawayPriors& priors) {
  const ContactFit& fit = object.presses.best();
  const bool is_by_presses = fit.is_valid && fit.covariance(1, 1) > 0.0;
  if (!is_by_presses || !fit.damping.is_excited) return priors.damping_std;
  const double k = fit.stiffness.value;
  const Eigen::Vector3d by(-fit.damping.value / (k * k), 1.0 / k, 0.0);
  return std::sqrt(std::max(by.dot(fit.covariance * by), 0.0));
}

double largest_force(const std::vector<Contact*>& contacts) {
  double largest = 0.0;
  for (const Contact* one : contacts) largest = std::max(largest, one->peak_force);
  return largest;
}

bool is_mostly_turning(const std::vector<FrictionSample>& samples) {
  const auto turning = std::count_if(samples.begin(), samples.end(),
                                     [](const FrictionSample& one) { return one.is_turning; });
  return 2 * turning > static_cast<std::ptrdiff_t>(samples.size());
}

/// Mass, friction and damping of all slides: with the mass that was weighed, and without.
struct SlidesPosterior {
  FrictionPosterior joint;
  /// The mass by accelerations alone, which checks a weighed mass.
  IdentifiedParameter inertial_mass;
  bool has_given_mass = false;  ///< the given mass is part of `joint`
};

SlidesPosterior infer(const std::vector<FrictionSample>& samples, std::optional<double> given_mass,
                      bool is_weighed, FrictionPriors priors) {
  SlidesPosterior result{infer_friction(samples, priors), {}, false};
  // In pushes that turn the object, the few samples between turns show how friction differs from
  // place to place more than they show a mass.
  if (is_mostly_turning(samples)) {
    result.joint.mass.is_excited = false;
    result.joint.coefficient.is_excited = false;  // by that mass; by the given one, see below
  }
  const IdentifiedParameter& mass = result.inertial_mass = result.joint.mass;
  const bool is_contradicted = given_mass && !is_weighed && mass.is_excited &&
                               std::abs(mass.value - *given_mass) > kMassContradiction * mass.std;
  if (!given_mass || is_contradicted) return result;
  priors.mass = given_mass;
  result.joint = infer_friction(samples, priors);
  result.has_given_mass = true;
  return result;
}

void take_correlation(const SlidesPosterior& found, ParameterSources& sources) {
  // `by` maps mass, Coulomb force and viscous friction to mass, coefficient and viscous friction,
  // with the constant factor 1 / (M g) left out.
  Eigen::Matrix3d by = Eigen::Matrix3d::Identity();
  by(1, 0) = -found.joint.coulomb.value / found.joint.mass.value;
  const Eigen::Matrix3d covariance = by * found.joint.covariance * by.transpose();
  std::vector<std::string> keys = {"mass", "sliding_friction_coefficient", "viscous_friction"};
  remove_correlation(keys, sources);
  const Eigen::Index rows = found.has_given_mass ? 2 : 3;
  if (found.has_given_mass) keys.erase(keys.begin());
  set_correlation(keys, covariance.bottomRightCorner(rows, rows), sources);
}

/// Mass and coefficient come from one posterior: a coefficient by the weighed mass beside the mass
/// by accelerations alone would give a wrong product, the friction at standstill.
void take_sliding(const SlidesPosterior& found, std::optional<double> weighed_mass,
                  ObjectIdentification& result) {
  const FrictionPosterior& joint = result.friction = found.joint;
  if (!joint.is_valid) return;
  SlidingIdentification& sliding = result.sliding;
  sliding.is_valid = true;
  sliding.mass = found.inertial_mass;
  sliding.coulomb = joint.coulomb;
  sliding.viscous = joint.viscous;
  sliding.coefficient = joint.coefficient;
  sliding.proposal.clear();
  if (!sliding.mass.is_excited || !joint.viscous.is_excited) {
    sliding.proposal = "modulate the push at 2 Hz, 3 mm, on 60 mm/s, without stopping: ";
    sliding.proposal += sliding.mass.is_excited ? "viscous friction was" : "the mass was";
    sliding.proposal += " not excited";
  }
  ObjectParameters& parameters = result.parameters;
  parameters.sliding_force = joint.sliding_force;
  parameters.inertial_mass.reset();
  result.is_mass_given = found.has_given_mass;
  const auto pushes = static_cast<int>(joint.pushes);
  if (found.has_given_mass) {
    if (weighed_mass) parameters.mass = ParameterValue{*weighed_mass, {}};
    if (sliding.mass.is_excited) parameters.inertial_mass = as_value(sliding.mass);
  } else if (joint.mass.is_excited) {
    parameters.mass = as_value(joint.mass);
    parameters.sources.pushes["mass"] = pushes;
  }
  if (joint.coefficient.is_excited && joint.coefficient.value > 0.0) {
    parameters.sliding_friction_coefficient = as_value(joint.coefficient);
    // Excited or not: only both together give the force at the speeds that were pushed.
    parameters.viscous_friction = as_value(joint.viscous);
    parameters.sources.pushes["sliding_friction_coefficient"] = pushes;
    parameters.sources.pushes["viscous_friction"] = pushes;
    take_correlation(found, parameters.sources);
  }
}

}  // namespace

void identify_friction_of(std::vector<Contact>& contacts, std::size_t object,
                          std::optional<double> given_mass, const BodyMotion& body,
                          const PathView& tip, double tool_radius,
                          const IdentificationOptions& options, ObjectIdentification& result) {
  std::vector<Contact*> pushes = contacts_of(contacts, object, false);
  const std::vector<Contact*> all = pushes;
  const auto off_centre = std::stable_partition(pushes.begin(), pushes.end(), [&](Contact* push) {
    push->breakaway_lever = lever_at(push->breakaway.t, *push, body, tip, tool_radius);
    push->breakaway_turning = turning_at_breakaway(*push, body);
    return is_centred(push) && std::abs(push->breakaway_lever) <= kMaxCentredLever;
  });
  pushes.erase(off_centre, pushes.end());
  const std::optional<HuntCrossley> contact_law = contact_law_of(result.parameters);
  std::optional<double> known_mass = given_mass;
  if (!known_mass && result.parameters.mass) known_mass = result.parameters.mass->value;
  if (contact_law) {
    std::vector<ForceMotion> slides;
    for (const Contact* push : pushes) {
      if (push->kind == ContactKind::slide) slides.push_back(push->series());
    }
    SlidingOptions sliding = options.sliding;
    sliding.mass = known_mass;
    result.sliding = identify_sliding(slides, *contact_law, sliding);
  }
  const double pressed = largest_force(contacts_of(contacts, object, true));
  const ContactCompliance compliance{
      contact_law, compliance_std(result, pressed, largest_force(all), options.breakaway_priors),
      damping_std(result, options.breakaway_priors)};
  FrictionPriors priors = options.friction_priors;
  priors.gravity = options.sliding.gravity;
  const auto infer_sliding = [&] {
    KnownSupport support;
    if (const auto& radius = result.parameters.friction_radius)
      support.friction_radius = radius->value;
    if (known_mass) support.weight = *known_mass * priors.gravity;
    result.slide_samples = friction_samples(body.tracked.empty() ? pushes : all, compliance, body,
                                            tip, tool_radius, support);
    return infer(result.slide_samples, known_mass, given_mass.has_value(), priors);
  };
  // The object's turning depends on its viscous friction, which hardly depends on the turning.
  SlidesPosterior sliding = infer_sliding();
  if (!body.tracked.empty()) {
    const FrictionPosterior& first = sliding.joint;
    // Unknown, it has its prior: it biases the friction radius by up to 15 %.
    const ParameterValue viscous =
        first.is_valid
            ? as_value(first.viscous)
            : ParameterValue{0.5 * priors.max_viscous, priors.max_viscous / std::sqrt(12.0)};
    identify_turning_of(contacts, object, body, tip, tool_radius, viscous, options, result);
    if (result.friction_radius) sliding = infer_sliding();
  }
  take_sliding(sliding, given_mass, result);
  const IdentifiedParameter radius = support_radius(body, result.parameters, priors);
  const std::vector<Contact*> at_limit =
      pushes_at_limit(all, pushes, body, tip, tool_radius, radius, options, result);
  find_limits(at_limit, compliance, radius, options, result);
  // An object that turned while it was loaded, too, seems softer than it is.
  if (result.is_exponent_given && is_mostly_turning(result.slide_samples)) {
    result.is_contact_off_centre = true;
  }
}

}  // namespace pcavr
