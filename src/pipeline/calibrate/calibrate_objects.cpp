// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_objects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/physics/inputs/touch.hpp"

#include "placement_fit.hpp"

namespace pcavr {
namespace {

using Parameters = ObjectParameterSet;

/// Stds beyond which a parameter is not observable: [m], [rad], 1.
constexpr std::array<double, kObjectParameters> kMaxStd{
    5e-3, 5e-3, 5e-3, 3.0 * kRadPerDegree, 3.0 * kRadPerDegree, 3.0 * kRadPerDegree, 0.03};
/// Fewer contacts leave nothing by which others could be judged.
constexpr std::size_t kMinTouches = 4;
constexpr int kTurns = 12;  ///< of the stated pose about the vertical, from which is searched
/// A scale that is not this many stds from 1 is 1.
constexpr double kScaleStds = 3.0;
/// Another turn that fits within this factor of the best one's median error is as good, and one
/// within this distance [m], by which a tip presses in and a tracker errs.
constexpr double kAsGood = 1.1, kAlike = 1e-3;
/// One contact of so many may be with something else.
constexpr std::size_t kMaxElsewhere = 5;
/// [m] Median distance of the tip from the surface in a contact with it.
constexpr double kMaxMisfit = 5e-3;
/// [rad] Turns closer than this are one.
constexpr double kSameTurn = 10.0 * kRadPerDegree;

/// The largest std against what is observable: up to 1 all are.
double uncertainty(const ObjectStds& stds) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    largest = std::max(largest, stds[i] / kMaxStd[i]);
  }
  return largest;
}

/// The mesh's axis that is nearest to the vertical.
int vertical_axis(const TouchedObject& object) {
  const Eigen::Vector3d up = object.T_tracked_object.rotation().conjugate() * object.up_tracked;
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return axis;
}

/// The parameters in the order in which contacts of a tip that pushes show them.
std::array<std::size_t, kObjectParameters> order_of(int vertical) {
  const auto up = static_cast<std::size_t>(vertical);
  const std::size_t first = (up + 1) % 3, second = (up + 2) % 3;
  return {first, second, 3 + up, kObjectScale, up, 3 + first, 3 + second};
}

/// [m] Median distance of the tip from the surface; points out of reach are infinitely far.
double error_of(const PlacementProblem& problem, const MeshPlacement& placement) {
  std::vector<double> sizes;
  for (const ContactPoint& point : problem.object.points) {
    if (point.contact == problem.without) continue;
    const auto gap = gap_of(point, placement, problem.surface, problem.object.tip_radius);
    sizes.push_back(gap ? std::abs(gap->value) : HUGE_VAL);
  }
  return sizes.empty() ? HUGE_VAL : median(std::move(sizes));
}

/// A fit of the plane's parameters from the stated pose and turns of it; the others as good as it.
struct Search {
  MeshPlacement placement = {};
  std::vector<double> as_good = {};  ///< [rad] turns from the placement
};

Search search(const PlacementProblem& problem, const Parameters& plane) {
  struct Candidate {
    MeshPlacement placement;
    double error = 0.0, turn = 0.0;
  };
  std::vector<Candidate> candidates;
  const Pose& T_stated = problem.object.T_tracked_object;
  const Eigen::Vector3d up = T_stated.rotation().conjugate() * problem.object.up_tracked;
  const bool turns = plane[3 + static_cast<std::size_t>(vertical_axis(problem.object))];
  for (int i = 0; i < (turns ? kTurns : 1); ++i) {
    // From the stated pose outward: 0, 30, -30, 60, ... degrees.
    const int steps = i % 2 == 1 ? (i + 1) / 2 : -i / 2;
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = 2.0 * std::numbers::pi * steps / kTurns * up;
    const MeshPlacement found = fitted(problem, plane, {T_stated * Pose::exp(turn), 1.0});
    candidates.push_back(
        {found, error_of(problem, found), rotation_distance(T_stated, found.T_tracked_object)});
  }
  const double least =
      std::min_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.error < b.error; })
          ->error;
  const double limit = std::max(kAsGood * least, kAlike);
  std::erase_if(candidates, [&](const Candidate& one) { return one.error > limit; });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.turn < b.turn; });
  Search found{.placement = candidates.front().placement};
  for (const Candidate& other : candidates) {
    const double turn =
        rotation_distance(found.placement.T_tracked_object, other.placement.T_tracked_object);
    const bool is_known =
        std::any_of(found.as_good.begin(), found.as_good.end(),
                    [&](double known) { return std::abs(known - turn) < kSameTurn; });
    if (turn > kSameTurn && !is_known) found.as_good.push_back(turn);
  }
  return found;
}

bool has_any(const Parameters& parameters) {
  return std::any_of(parameters.begin(), parameters.end(), [](bool one) { return one; });
}

/// The positions in the plane and the turn about the vertical.
Parameters in_plane(const TouchedObject& object) {
  Parameters plane{};
  const auto order = order_of(vertical_axis(object));
  for (std::size_t i = 0; i < 3; ++i) plane[order[i]] = true;
  return plane;
}

/// The fit from the best start; parameters that are not free are as stated.
Search placed(const PlacementProblem& problem, const Parameters& free) {
  Parameters plane = in_plane(problem.object);
  for (std::size_t i = 0; i < kObjectParameters; ++i) plane[i] = plane[i] && free[i];
  Search found{.placement = {problem.object.T_tracked_object, 1.0}};
  if (has_any(plane)) found = search(problem, plane);
  found.placement = fitted(problem, free, found.placement);
  return found;
}

/// Adds the parameters of the group that the contacts show, the most certain first. They are judged
/// where they are: along a flat face a step leads anywhere, and an edge there looks like a sign.
void add_shown(const PlacementProblem& problem, std::span<const std::size_t> group, double variance,
               MeshPlacement& placement, Parameters& free) {
  while (true) {
    std::optional<std::size_t> best;
    double least = 1.0;
    for (const std::size_t parameter : group) {
      if (free[parameter]) continue;
      Parameters more = free;
      more[parameter] = true;
      const double now = uncertainty(expected_stds(problem, more, placement, variance));
      if (!(now <= least)) continue;
      least = now;
      best = parameter;
    }
    if (!best) return;
    free[*best] = true;
    placement = fitted(problem, free, placement);
  }
}

/// The parameters that the contacts show, by their slopes: first those in the plane, from the best
/// fit of all of them, whose residuals say what a gap is good for.
Parameters shown_parameters(const PlacementProblem& problem, MeshPlacement placement) {
  const Parameters plane = in_plane(problem.object);
  const double variance = variance_of(problem, plane, placement);
  const auto order = order_of(vertical_axis(problem.object));
  Parameters free{};
  add_shown(problem, std::span(order).first<3>(), variance, placement, free);
  add_shown(problem, std::span(order).last<4>(), variance, placement, free);
  return free;
}

/// The parameter whose std is largest against what is observable.
std::size_t worst_parameter(const ObjectStds& stds) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < kObjectParameters; ++i) {
    if (stds[i] / kMaxStd[i] > stds[worst] / kMaxStd[worst]) worst = i;
  }
  return worst;
}

/// Fits those parameters, without what the jackknife shows not to be certain, and a scale of 1.
Search settle(const PlacementProblem& problem, const MeshPlacement& in_plane_alone,
              CalibratedObject& found) {
  Parameters free = shown_parameters(problem, in_plane_alone);
  while (has_any(free)) {
    const Search best = placed(problem, free);
    const MeshPlacement& placement = best.placement;
    const std::vector<MeshPlacement> without = without_each(problem, free, placement);
    found.stds =
        mean_stds(jackknife_stds(placement, without),
                  expected_stds(problem, free, placement, variance_of(problem, free, placement)));
    found.held_out_rms = held_out_rms(problem, without);
    found.is_observable = free;
    const std::size_t worst = worst_parameter(found.stds);
    if (!(found.stds[worst] <= kMaxStd[worst])) {
      free[worst] = false;
      continue;
    }
    const bool is_stated_size = free[kObjectScale] && std::abs(placement.scale - 1.0) <=
                                                          kScaleStds * found.stds[kObjectScale];
    if (!is_stated_size) return best;
    const UncertainText scale = uncertain(placement.scale, found.stds[kObjectScale]);
    found.notes.push_back(fmt::format("{}: its mesh has the right size: {} +- {} of it", found.name,
                                      scale.value, scale.std));
    free[kObjectScale] = false;
  }
  found.is_observable = free;
  return placed(problem, free);
}

/// How many contacts are not at the surface.
std::size_t contacts_elsewhere(const PlacementProblem& problem, const MeshPlacement& placement) {
  std::size_t elsewhere = 0;
  for (std::size_t contact = 0; contact < problem.object.contacts; ++contact) {
    std::vector<double> sizes;
    for (const ContactPoint& point : problem.object.points) {
      if (point.contact != contact) continue;
      const auto gap = gap_of(point, placement, problem.surface, problem.object.tip_radius);
      if (gap) sizes.push_back(std::abs(gap->value));
    }
    elsewhere += sizes.empty() || median(std::move(sizes)) > kMaxMisfit ? 1 : 0;
  }
  return elsewhere;
}

/// An Error where too many contacts are not at the surface, and where fewer would be with
/// parameters that the contacts do not show.
std::optional<Error> misfit_of(const PlacementProblem& problem, const MeshPlacement& placement,
                               const MeshPlacement& in_plane_alone) {
  const std::string& name = problem.object.name;
  const std::size_t elsewhere = contacts_elsewhere(problem, placement);
  const std::size_t at_best = contacts_elsewhere(problem, in_plane_alone);
  if (at_best < elsewhere) {
    return Error{.message = "the contacts do not show where " + name +
                            " is: several places fit them, and the stated one does not",
                 .hint = "push it at several places of all of its sides"};
  }
  if (elsewhere * kMaxElsewhere <= problem.object.contacts) return std::nullopt;
  return Error{
      .message = fmt::format("{} of {} contacts are farther than 5 mm from the surface of {}, "
                             "wherever its mesh is put",
                             elsewhere, problem.object.contacts, name),
      .hint =
          "check the mesh and its unit, the tool's radius, that the clocks agree, and that the "
          "tip touches nothing else"};
}

}  // namespace

Expected<CalibratedObject> calibrate_object(const TouchedObject& object) {
  if (object.contacts < kMinTouches) {
    return Error{.message = fmt::format("{} is touched in {} contacts, and {} are needed",
                                        object.name, object.contacts, kMinTouches),
                 .hint = "push it at several places of all of its sides"};
  }
  const BodySurface surface(object.model);
  const PlacementProblem problem{object, surface};
  CalibratedObject found{.name = object.name, .contacts = object.contacts};
  const MeshPlacement in_plane_alone = search(problem, in_plane(object)).placement;
  const Search best = settle(problem, in_plane_alone, found);
  if (!has_any(found.is_observable)) {
    return Error{.message = "the contacts do not show where " + object.name + " is",
                 .hint = "push it at several places of all of its sides"};
  }
  const MeshPlacement& placement = best.placement;
  if (auto error = misfit_of(problem, placement, in_plane_alone)) return *std::move(error);
  found.T_tracked_object = placement.T_tracked_object;
  found.scale = placement.scale;
  found.mesh_unit = object.mesh_unit * placement.scale;
  found.from_stated = object.T_tracked_object.inverse() * placement.T_tracked_object;
  found.before_rms = rms_of(gaps_of(problem, {object.T_tracked_object, 1.0}));
  found.fitted_rms = rms_of(gaps_of(problem, placement));
  if (const std::size_t elsewhere = contacts_elsewhere(problem, placement); elsewhere > 0) {
    found.notes.push_back(
        fmt::format("{}: {} of {} contacts are farther than 5 mm from its surface", object.name,
                    elsewhere, object.contacts));
  }
  for (const double turn : best.as_good) {
    found.notes.push_back(fmt::format(
        "{} turned by {:.0f} degrees fits the contacts as well: the one nearest to the stated pose "
        "is taken",
        object.name, turn / kRadPerDegree));
  }
  return found;
}

}  // namespace pcavr
