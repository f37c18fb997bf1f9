// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/physics/identification/local_direction.hpp"

#include "physics/object_identification/contact_fits.hpp"
#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

/// Pushes on one face have normals this near to each other.
constexpr double kSameFace = 0.98;
/// Relative bias of the stiffness under `kExponentOfPushes` by creep: 2 to 4 % on simulated plants.
constexpr double kCreep = 0.04;
constexpr double kMinStds = 2.0;        // a stiffness nearer to 0 is not identified
constexpr double kMaxDepthShare = 2.0;  // of the tip's way: it is pressed in a little at touch

/// All presses share one surface position where they have the same direction.
bool is_one_surface(const std::vector<Contact*>& presses) {
  return std::all_of(presses.begin(), presses.end(), [&](const Contact* press) {
    return press->direction_base.dot(presses.front()->direction_base) > 0.999999;
  });
}

/// States how many presses, or pushes, the contact law rests on. A damping that is only bounded
/// rests on none.
void count_sources(bool by_presses, int count, bool has_damping, ObjectParameters& parameters) {
  ParameterSources& sources = parameters.sources;
  for (const char* key :
       {"contact.stiffness", "contact.damping", "contact.exponent", "contact.mass"}) {
    sources.presses.erase(key);
    sources.pushes.erase(key);
    const bool is_damping = std::string_view(key) == "contact.damping";
    if (is_damping && !(has_damping && parameters.contact_damping)) continue;
    if (std::string_view(key) == "contact.mass" && !parameters.contact_mass) continue;
    (by_presses ? sources.presses : sources.pushes)[key] = count;
  }
}

void take_parameters(const ContactFit& fit, ObjectParameters& parameters) {
  parameters.contact_stiffness = as_value(fit.stiffness);
  parameters.contact_exponent = as_value(fit.exponent);
  parameters.contact_damping_law.reset();
  parameters.contact_mass.reset();
  if (fit.mass.is_excited) parameters.contact_mass = as_value(fit.mass);
  parameters.contact_damping = damping_of(fit);
}

/// A stiffness that depends on an assumed exponent by more than it is known: the law is right
/// about its penetration only, and the stiffness is no result.
void assume_stiffness(ObjectIdentification& result) {
  result.parameters.contact_stiffness->std.reset();
  result.parameters.sources.pushes.erase("contact.stiffness");
  result.notes.push_back(fmt::format(
      "the stiffness is not identified: its exponent, {:.2f}, is assumed, and so is its "
      "unit; only the penetration is known; press along z to identify them",
      result.parameters.contact_exponent->value));
}

bool has_value(const std::optional<ParameterValue>& known, const IdentifiedParameter& found) {
  return known && known->value == found.value;
}

/// Takes the correlation of the law's parameters that are the fit's own: a damping that is only
/// bounded is not, and impacts may have given another one.
void take_correlation(const ContactFit& fit, ObjectParameters& parameters) {
  const std::pair<const char*, bool> rows[] = {
      {"contact.stiffness", has_value(parameters.contact_stiffness, fit.stiffness)},
      {"contact.damping",
       fit.damping.is_excited && has_value(parameters.contact_damping, fit.damping)},
      {"contact.exponent", has_value(parameters.contact_exponent, fit.exponent)}};
  std::vector<std::string> keys;
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < 3; ++i) {
    remove_correlation({rows[i].first}, parameters.sources);
    if (!rows[i].second || fit.covariance(i, i) <= 0.0) continue;
    keys.emplace_back(rows[i].first);
    chosen.push_back(i);
  }
  if (keys.size() < 2) return;
  set_correlation(keys, fit.covariance(chosen, chosen), parameters.sources);
}

/// The contact's series with the tip moved back by its common std, kept in `tool`.
ForceMotion shallower(const ForceMotion& series, const std::vector<double>& tip_std,
                      std::vector<double>& tool) {
  tool.assign(series.tool.begin(), series.tool.end());
  for (std::size_t i = 0; i < tool.size() && i < tip_std.size(); ++i) tool[i] -= tip_std[i];
  return {series.t, tool, series.force, series.tool_noise};
}

double depth_at(double force, const ContactFit& fit) {
  return std::pow(force / fit.stiffness.value, 1.0 / fit.exponent.value);
}

/// Adds the difference from the fit of moved tips; `force` [N]: the largest of these contacts.
void add_change(const ContactFit& moved, double force, ContactFit& fit) {
  if (!fit.is_valid || !moved.is_valid) return;
  const double depth = depth_at(force, fit);
  fit.penetration_std = std::hypot(fit.penetration_std, depth_at(force, moved) / depth - 1.0);
  const Eigen::Vector3d change(moved.stiffness.value - fit.stiffness.value,
                               moved.damping.value - fit.damping.value,
                               moved.exponent.value - fit.exponent.value);
  fit.covariance += change * change.transpose();
  const auto add = [&](IdentifiedParameter ContactFit::*parameter) {
    IdentifiedParameter& found = fit.*parameter;
    found.std = std::hypot(found.std, (moved.*parameter).value - found.value);
  };
  add(&ContactFit::stiffness);
  add(&ContactFit::damping);
  add(&ContactFit::exponent);
}

/// Adds to the stds what an error of the tip by one std changes, the same in all contacts: the tip
/// is less deep than it seems, as what carries it gives way. `local` as of identify_contact.
void add_tip_uncertainty(const std::vector<ForceMotion>& series,
                         const std::vector<ForceMotion>& local,
                         const std::vector<const Contact*>& contacts,
                         const ContactFitOptions& options, ContactFits& fits,
                         ContactIdentification& found) {
  const bool is_known = std::all_of(contacts.begin(), contacts.end(),
                                    [](const auto* contact) { return contact->tip_std.empty(); });
  if (is_known) return;
  std::vector<std::vector<double>> tools(series.size()), local_tools(local.size());
  std::vector<ForceMotion> moved, moved_local;
  for (std::size_t i = 0; i < series.size(); ++i) {
    moved.push_back(shallower(series[i], contacts[i]->tip_std, tools[i]));
  }
  for (std::size_t i = 0; i < local.size(); ++i) {
    moved_local.push_back(shallower(local[i], contacts[i]->tip_std, local_tools[i]));
  }
  const ContactIdentification shallow = fits.fit(moved, options, moved_local);
  double force = 0.0;
  for (const Contact* contact : contacts) {
    force = std::max(force, contact->peak_force);
  }
  add_change(shallow.hunt_crossley, force, found.hunt_crossley);
  add_change(shallow.mass_damper_spring, force, found.mass_damper_spring);
}

/// The push until the breakaway alarm: the object is at rest.
ForceMotion until_alarm(const Contact& contact) {
  const double until = contact.breakaway.is_found ? contact.breakaway.t_alarm : contact.end;
  const auto end = std::lower_bound(contact.t.begin(), contact.t.end(), until);
  const auto count = static_cast<std::size_t>(end - contact.t.begin());
  const ForceMotion all = contact.series();
  return {all.t.first(count), all.tool.first(count), all.force.first(count), all.tool_noise};
}

/// Whether no tip would be deeper in the object than twice its way, to it and in contact: else
/// the object gave way before its breakaway was found, and the law is that of its friction.
bool is_within_travel(const ContactFit& fit, const std::vector<ForceMotion>& pushes) {
  double force = 0.0, travel = 0.0;
  for (const ForceMotion& push : pushes) {
    if (push.tool.empty()) continue;
    force = std::max(force, *std::max_element(push.force.begin(), push.force.end()));
    const auto [first, last] = std::minmax_element(push.tool.begin(), push.tool.end());
    travel = std::max(travel, *last - *first);
  }
  return depth_at(force, fit) <= kMaxDepthShare * travel;
}

/// Relative std of the stiffness from push to push, which the joint fit does not include.
double stiffness_scatter(const std::vector<ForceMotion>& pushes, const ContactFitOptions& options,
                         ContactFits& fits) {
  std::vector<double> logs;
  for (const ForceMotion& push : pushes) {
    const ContactFit fit = fits.fit(std::span(&push, 1), options).best();
    if (fit.is_valid) logs.push_back(std::log(fit.stiffness.value));
  }
  if (logs.size() < 2) return 0.0;
  double mean = 0.0, squares = 0.0;
  for (const double value : logs) mean += value / static_cast<double>(logs.size());
  for (const double value : logs) squares += std::pow(value - mean, 2);
  return std::sqrt(squares / static_cast<double>(logs.size() - 1));
}

std::vector<FaceContact> identify_faces(const std::vector<Contact*>& pushes,
                                        const ParameterValue& exponent, ContactFitOptions options,
                                        ContactFits& fits) {
  std::vector<FaceContact> faces;
  std::vector<std::vector<ForceMotion>> series;
  std::vector<std::vector<const Contact*>> sources;
  for (const Contact* push : pushes) {
    const Eigen::Vector3d& normal = push->normal_object;
    const auto face = std::find_if(faces.begin(), faces.end(), [&](const FaceContact& known) {
      return known.normal_object.dot(normal) > kSameFace;
    });
    const auto index = static_cast<std::size_t>(face - faces.begin());
    if (face == faces.end()) {
      faces.push_back({normal, 0, {}, false});
      series.emplace_back();
      sources.emplace_back();
    }
    ++faces[index].pushes;
    sources[index].push_back(push);
    series[index].push_back(until_alarm(*push));
  }
  options.is_surface_shared = false;  // the object moves between pushes
  options.exponent = exponent.value;
  options.exponent_std = exponent.std.value_or(0.0);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    faces[i].contact = fits.fit(series[i], options);
    add_tip_uncertainty(series[i], {}, sources[i], options, fits, faces[i].contact);
    ContactFit& fit = faces[i].contact.hunt_crossley;
    if (!fit.is_valid) continue;
    const double share = std::hypot(kCreep, stiffness_scatter(series[i], options, fits));
    fit.stiffness.std = std::hypot(fit.stiffness.std, fit.stiffness.value * share);
    fit.penetration_std = std::hypot(fit.penetration_std, share / fit.exponent.value);
    faces[i].is_usable = fit.penetration_std * fit.exponent.value < 1.0 / kMinStds &&
                         is_within_travel(fit, series[i]);
    fit.stiffness.is_excited =
        faces[i].is_usable && fit.stiffness.value > kMinStds * fit.stiffness.std;
  }
  return faces;
}

/// Presses that begin or end within the record show no depth, and any law fits them: then a std of
/// the depth is larger than the depth.
void withhold_undetermined(ContactIdentification& found) {
  if (!found.best().is_valid || found.best().penetration_std < 1.0) return;
  found.mass_damper_spring.is_valid = false;
  found.hunt_crossley.is_valid = false;
  found.proposal =
      "press again, with free motion before and after the press: the depth of the contact is not "
      "determined, and so no stiffness was identified";
}

/// The contact law of presses on what stays, or moves under them while the tip travels.
ContactIdentification identify_presses(const std::vector<Contact*>& presses,
                                       const std::vector<ForceMotion>& series, const PathView& tip,
                                       ContactFitOptions options, ContactFits& fits) {
  options.is_surface_shared = options.is_surface_shared && is_one_surface(presses);
  std::vector<LocalContact> contacts;
  std::vector<ForceMotion> local;
  contacts.reserve(presses.size());
  for (const Contact* press : presses) {
    contacts.push_back(
        along_local_force(press->t, press->force_base, tip, options.moving_half_width));
    local.push_back(contacts.back().series(press->tool_noise));
  }
  ContactIdentification found = fits.fit(series, options, local);
  add_tip_uncertainty(series, local, {presses.begin(), presses.end()}, options, fits, found);
  withhold_undetermined(found);
  return found;
}

}  // namespace

void identify_contact_of(std::vector<Contact>& contacts, std::size_t object, const PathView& tip,
                         const IdentificationOptions& options, ContactFits& fits,
                         ObjectIdentification& result) {
  auto presses = contacts_of(contacts, object, true);
  auto pushes = contacts_of(contacts, object, false);
  if (!result.is_movable) {
    presses.insert(presses.end(), pushes.begin(), pushes.end());
    pushes.clear();
  }
  std::vector<Contact*> centred;
  std::copy_if(pushes.begin(), pushes.end(), std::back_inserter(centred), is_centred);
  std::vector<ForceMotion> series;
  series.reserve(presses.size());
  for (const Contact* press : presses) series.push_back(press->series());
  result.press_count = static_cast<int>(presses.size());
  if (!series.empty()) {
    result.presses = identify_presses(presses, series, tip, options.contact_fit, fits);
    if (!result.presses.best().is_valid) result.notes.push_back(result.presses.proposal);
  }
  const ParameterValue exponent = result.parameters.contact_exponent.value_or(
      ParameterValue{kExponentOfPushes, kExponentStdOfPushes});
  result.is_contact_off_centre = centred.empty() && !pushes.empty();
  result.faces = identify_faces(result.is_contact_off_centre ? pushes : centred, exponent,
                                options.contact_fit, fits);

  const ContactFit* best = nullptr;
  int count = result.press_count;
  if (result.presses.best().is_valid) {
    best = &result.presses.best();
    if (options.compares_estimators)
      result.comparison = compare_estimators(series, result.presses, options.estimator);
  } else if (const FaceContact* face = face_of_law(result)) {
    count = face->pushes;
    best = &face->contact.best();
  }
  if (best == nullptr || result.presses.best().is_valid) result.is_contact_off_centre = false;
  if (best != nullptr) {
    take_parameters(*best, result.parameters);
    const bool by_presses = result.presses.best().is_valid;
    for (const Contact* one : by_presses ? presses : pushes) {
      double& force = result.penetration.max_force;
      force = std::max(force, one->peak_force);
    }
    result.penetration.relative_std = std::hypot(
        best->penetration_std, curvature_std(result.presses, *best, result.penetration.max_force));
    result.is_exponent_given = !result.presses.best().is_valid;
    if (result.is_exponent_given) result.parameters.contact_mass.reset();
    if (result.is_exponent_given) {
      result.parameters.contact_exponent = exponent;
      result.parameters.contact_damping.reset();  // creep biases the damping, too
    }
    count_sources(!result.is_exponent_given, count, best->damping.is_excited, result.parameters);
    if (result.is_exponent_given) result.parameters.sources.pushes.erase("contact.exponent");
    if (!best->stiffness.is_excited && result.is_exponent_given) assume_stiffness(result);
  }
  identify_impacts(contacts, object, options.damping_law, result);
  if (best != nullptr) take_correlation(*best, result.parameters);
}

void forget_contact(ObjectParameters& parameters) {
  parameters.contact_stiffness.reset();
  parameters.contact_damping.reset();
  parameters.contact_exponent.reset();
  for (const char* key : {"contact.stiffness", "contact.damping", "contact.exponent"}) {
    parameters.sources.pushes.erase(key);
    std::erase(parameters.sources.given, key);
    remove_correlation({key}, parameters.sources);
  }
}

void withhold_contact_off_centre(ObjectIdentification& result) {
  if (!result.is_contact_off_centre) return;
  forget_contact(result.parameters);
  result.notes.emplace_back(
      "the pushes are off the centre of mass: the contact law is not identified, because the "
      "object turns under the load; press along z, or push through the centre");
}

}  // namespace pcavr
