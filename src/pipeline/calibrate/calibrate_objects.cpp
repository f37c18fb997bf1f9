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

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/physics/inputs/touch.hpp"

#include "yaml_text.hpp"

namespace pcavr {
namespace {

using Parameters = std::array<bool, kObjectParameters>;
using Step = Eigen::Matrix<double, 7, 1>;
using Information = Eigen::Matrix<double, 7, 7>;

constexpr std::array<const char*, kObjectParameters> kParameterNames{
    "x", "y", "z", "rotation about x", "rotation about y", "rotation about z", "scale"};
constexpr std::size_t kScale = 6;
constexpr double kPerDegree = std::numbers::pi / 180.0;
/// Stds beyond which a parameter is not observable: [m], [rad], 1.
constexpr std::array<double, kObjectParameters> kMaxStd{
    5e-3, 5e-3, 5e-3, 3.0 * kPerDegree, 3.0 * kPerDegree, 3.0 * kPerDegree, 0.03};
/// Fewer contacts leave nothing by which others could be judged.
constexpr std::size_t kMinContacts = 4;
constexpr int kTurns = 12;  ///< of the stated pose about the vertical, from which is searched
/// A scale that is not this many stds from 1 is 1.
constexpr double kScaleStds = 3.0;
/// Huber's threshold in standard deviations, 95 % efficient [Huber 1981].
constexpr double kHuberOfTouch = 1.345;
/// [m] The rounding of a distance: residuals below it are alike.
constexpr double kMinGap = 1e-5;
/// Residuals beyond this many stds are not those of touches.
constexpr double kUsualStds = 4.0;
/// Another turn that fits within this factor of the best one's median error is as good, and one
/// within this distance [m], by which a tip presses in and a tracker errs.
constexpr double kAsGood = 1.1, kAlike = 1e-3;
/// One contact of so many may be with something else.
constexpr std::size_t kMaxElsewhere = 5;
/// [m] Median distance of the tip from the surface in a contact with it.
constexpr double kMaxMisfit = 5e-3;
/// [rad] Turns closer than this are one.
constexpr double kSameTurn = 10.0 * kPerDegree;

/// Pose and scale of the mesh.
struct Placement {
  Pose T_tracked_object = {};
  double scale = 1.0;
};

/// The distance of the tip from the mesh's surface, and how it changes with the parameters.
struct Gap {
  double value = 0.0;  ///< [m]
  Step slope = Step::Zero();
};

std::optional<Gap> gap_of(const ContactPoint& point, const Placement& placement,
                          const BodySurface& surface, double tip_radius) {
  const Eigen::Vector3d p = placement.T_tracked_object.inverse() * point.p_tracked;
  const Touch touch = surface.touch({}, p / placement.scale, 0.0);
  if (!std::isfinite(touch.gap)) return std::nullopt;
  const Eigen::Vector3d outward = -touch.inward_base;
  Gap gap{.value = placement.scale * touch.gap - tip_radius};
  gap.slope.head<3>() = -outward;
  gap.slope.segment<3>(3) = -p.cross(outward);
  gap.slope[kScale] = touch.gap - outward.dot(p) / placement.scale;
  return gap;
}

Placement moved(const Placement& placement, const Step& step) {
  const Vector6d twist = step.head<6>();
  return {placement.T_tracked_object * Pose::exp(twist), placement.scale + step[kScale]};
}

/// What is fitted: an object's points, without those of one contact.
struct Problem {
  const TouchedObject& object;
  const BodySurface& surface;
  std::optional<std::size_t> without = {};
};

std::vector<Gap> gaps_of(const Problem& problem, const Placement& placement) {
  std::vector<Gap> gaps;
  for (const ContactPoint& point : problem.object.points) {
    if (point.contact == problem.without) continue;
    const auto gap = gap_of(point, placement, problem.surface, problem.object.tip_radius);
    if (gap) gaps.push_back(*gap);
  }
  return gaps;
}

double median_size(const std::vector<Gap>& gaps) {
  std::vector<double> sizes;
  for (const Gap& gap : gaps) sizes.push_back(std::abs(gap.value));
  return median(std::move(sizes));
}

double std_of(const std::vector<Gap>& gaps) {
  return std::max(kMinGap, kStdOverMad * median_size(gaps));
}

double rms_of(const std::vector<Gap>& gaps) {
  double squares = 0.0;
  for (const Gap& gap : gaps) squares += gap.value * gap.value;
  return gaps.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(gaps.size()));
}

/// [m] rms of gaps that are not larger than is usual: a contact that is elsewhere counts as one at
/// the limit.
double usual_rms(std::vector<Gap> gaps) {
  const double limit = kUsualStds * std_of(gaps);
  for (Gap& gap : gaps) gap.value = std::clamp(gap.value, -limit, limit);
  return rms_of(gaps);
}

/// Sum of the weighted squares of the slopes; 1 on the diagonal of parameters that are kept.
Information information_of(const std::vector<Gap>& gaps, const Parameters& free, Step& right) {
  const double threshold = kHuberOfTouch * std_of(gaps);
  Information information = Information::Zero();
  right.setZero();
  for (const Gap& gap : gaps) {
    const double weight = std::min(1.0, threshold / std::max(std::abs(gap.value), kMinGap));
    Step slope = gap.slope;
    for (std::size_t i = 0; i < kObjectParameters; ++i) {
      if (!free[i]) slope[static_cast<Eigen::Index>(i)] = 0.0;
    }
    information += weight * slope * slope.transpose();
    right -= weight * gap.value * slope;
  }
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (!free[i]) information(at, at) = 1.0;
  }
  return information;
}

/// Gauss-Newton, damped; a step is limited, so that the nearest faces stay those that were linked.
Placement fitted(const Problem& problem, const Parameters& free, Placement placement) {
  constexpr int kRounds = 40;
  constexpr double kDamping = 1e-6, kMaxStep = 0.02, kMinStep = 1e-6;
  for (int round = 0; round < kRounds; ++round) {
    Step right;
    Information information = information_of(gaps_of(problem, placement), free, right);
    information.diagonal() *= 1.0 + kDamping;
    information.diagonal().array() += 1e-12;
    Step step = information.ldlt().solve(right);
    if (!step.allFinite()) break;
    const double size = std::max(step.head<3>().norm(), 0.1 * step.segment<3>(3).norm());
    if (size > kMaxStep) step *= kMaxStep / size;
    placement = moved(placement, step);
    placement.scale = std::clamp(placement.scale, 0.1, 10.0);
    if (step.norm() < kMinStep) break;
  }
  return placement;
}

/// [m^2] Of a point's gap by the residuals, one measurement for each contact: its points share
/// their errors.
double variance_of(const Problem& problem, const Parameters& free, const Placement& placement) {
  const std::vector<Gap> gaps = gaps_of(problem, placement);
  const auto fitted = static_cast<double>(std::count(free.begin(), free.end(), true));
  const double freedoms = std::max(1.0, static_cast<double>(problem.object.contacts) - fitted);
  return std::pow(std::max(kMinGap, usual_rms(gaps)), 2) * static_cast<double>(gaps.size()) /
         freedoms;
}

/// The stds that gaps of that variance leave.
std::array<double, kObjectParameters> expected_stds(const Problem& problem, const Parameters& free,
                                                    const Placement& placement, double variance) {
  Step unused;
  const Information information = information_of(gaps_of(problem, placement), free, unused);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd{information});
  std::array<double, kObjectParameters> stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    for (Eigen::Index k = 0; k < 7; ++k) {
      stds[i] += variance * std::pow(solver.eigenvectors()(at, k), 2) /
                 std::max(solver.eigenvalues()[k], 1e-15);
    }
    stds[i] = free[i] ? std::sqrt(stds[i]) : 0.0;
  }
  return stds;
}

/// The largest std against what is observable: up to 1 all are.
double uncertainty(const std::array<double, kObjectParameters>& stds) {
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
  return {first, second, 3 + up, kScale, up, 3 + first, 3 + second};
}

/// A fit of the plane's parameters from the stated pose and turns of it; the others as good as it.
struct Search {
  Placement placement = {};
  std::vector<double> as_good = {};  ///< [rad] turns from the placement
};

Search search(const Problem& problem, const Parameters& plane) {
  struct Candidate {
    Placement placement;
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
    const Placement found = fitted(problem, plane, {T_stated * Pose::exp(turn), 1.0});
    candidates.push_back({found, median_size(gaps_of(problem, found)),
                          rotation_distance(T_stated, found.T_tracked_object)});
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

/// The fits without one contact each.
std::vector<Placement> without_each(const Problem& problem, const Parameters& free,
                                    const Placement& placement) {
  std::vector<Placement> placements;
  for (std::size_t contact = 0; contact < problem.object.contacts; ++contact) {
    placements.push_back(fitted({problem.object, problem.surface, contact}, free, placement));
  }
  return placements;
}

std::array<double, kObjectParameters> jackknife_stds(const Placement& placement,
                                                     const std::vector<Placement>& without) {
  std::vector<Step> steps;
  Step mean = Step::Zero();
  const auto count = static_cast<double>(without.size());
  for (const Placement& other : without) {
    Step step;
    step << (placement.T_tracked_object.inverse() * other.T_tracked_object).log(),
        other.scale - placement.scale;
    steps.push_back(step);
    mean += step / count;
  }
  Step squares = Step::Zero();
  for (const Step& step : steps) squares += (step - mean).cwiseAbs2();
  std::array<double, kObjectParameters> stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    stds[i] = std::sqrt((count - 1.0) / count * squares[static_cast<Eigen::Index>(i)]);
  }
  return stds;
}

/// Of the mean variance. The jackknife's has as few freedoms as a side has contacts, which may
/// agree by chance; that by all residuals takes all contacts as alike.
std::array<double, kObjectParameters> mean_stds(
    const std::array<double, kObjectParameters>& jackknife,
    const std::array<double, kObjectParameters>& expected) {
  std::array<double, kObjectParameters> stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    stds[i] = std::sqrt(0.5 * (jackknife[i] * jackknife[i] + expected[i] * expected[i]));
  }
  return stds;
}

/// [m] Of each contact's points by the fit without it.
double held_out_rms(const Problem& problem, const std::vector<Placement>& without) {
  std::vector<Gap> gaps;
  for (const ContactPoint& point : problem.object.points) {
    const auto gap =
        gap_of(point, without[point.contact], problem.surface, problem.object.tip_radius);
    if (gap) gaps.push_back(*gap);
  }
  return rms_of(gaps);
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
Search placed(const Problem& problem, const Parameters& free) {
  Parameters plane = in_plane(problem.object);
  for (std::size_t i = 0; i < kObjectParameters; ++i) plane[i] = plane[i] && free[i];
  Search found{.placement = {problem.object.T_tracked_object, 1.0}};
  if (has_any(plane)) found = search(problem, plane);
  found.placement = fitted(problem, free, found.placement);
  return found;
}

/// Adds the parameters of the group that the contacts show, the most certain first. They are judged
/// where they are: along a flat face a step leads anywhere, and an edge there looks like a sign.
void add_shown(const Problem& problem, std::span<const std::size_t> group, double variance,
               Placement& placement, Parameters& free) {
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
Parameters shown_parameters(const Problem& problem) {
  const Parameters plane = in_plane(problem.object);
  Placement placement = search(problem, plane).placement;
  const double variance = variance_of(problem, plane, placement);
  const auto order = order_of(vertical_axis(problem.object));
  Parameters free{};
  add_shown(problem, std::span(order).first<3>(), variance, placement, free);
  add_shown(problem, std::span(order).last<4>(), variance, placement, free);
  return free;
}

/// The parameter whose std is largest against what is observable.
std::size_t worst_parameter(const std::array<double, kObjectParameters>& stds) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < kObjectParameters; ++i) {
    if (stds[i] / kMaxStd[i] > stds[worst] / kMaxStd[worst]) worst = i;
  }
  return worst;
}

/// Fits those parameters, without what the jackknife shows not to be certain, and a scale of 1.
Search settle(const Problem& problem, CalibratedObject& found) {
  Parameters free = shown_parameters(problem);
  while (has_any(free)) {
    const Search best = placed(problem, free);
    const Placement& placement = best.placement;
    const std::vector<Placement> without = without_each(problem, free, placement);
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
    const bool is_stated_size =
        free[kScale] && std::abs(placement.scale - 1.0) <= kScaleStds * found.stds[kScale];
    if (!is_stated_size) return best;
    const UncertainText scale = uncertain(placement.scale, found.stds[kScale]);
    found.notes.push_back(fmt::format("{}: its mesh has the right size: {} +- {} of it", found.name,
                                      scale.value, scale.std));
    free[kScale] = false;
  }
  found.is_observable = free;
  return placed(problem, free);
}

/// How many contacts are not at the surface.
std::size_t contacts_elsewhere(const Problem& problem, const Placement& placement) {
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
std::optional<Error> misfit_of(const Problem& problem, const Placement& placement) {
  const std::string& name = problem.object.name;
  const std::size_t elsewhere = contacts_elsewhere(problem, placement);
  const Parameters plane = in_plane(problem.object);
  const std::size_t at_best = contacts_elsewhere(problem, search(problem, plane).placement);
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
  if (object.contacts < kMinContacts) {
    return Error{.message = fmt::format("{} is touched in {} contacts, and {} are needed",
                                        object.name, object.contacts, kMinContacts),
                 .hint = "push it at several places of all of its sides"};
  }
  const BodySurface surface(object.model);
  const Problem problem{object, surface};
  CalibratedObject found{.name = object.name, .contacts = object.contacts};
  const Search best = settle(problem, found);
  if (!has_any(found.is_observable)) {
    return Error{.message = "the contacts do not show where " + object.name + " is",
                 .hint = "push it at several places of all of its sides"};
  }
  const Placement& placement = best.placement;
  if (auto error = misfit_of(problem, placement)) return *std::move(error);
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
        object.name, turn / kPerDegree));
  }
  return found;
}

std::string parameter_names(const CalibratedObject& found, bool observable) {
  std::string names;
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    if (found.is_observable[i] != observable) continue;
    names += (names.empty() ? "" : ", ") + std::string(kParameterNames[i]);
  }
  return names;
}

std::string describe_object(const CalibratedObject& found) {
  const double offset = found.from_stated.translation().norm();
  const double turn = rotation_distance(Pose(), found.from_stated);
  const std::string scale =
      found.scale == 1.0 ? "" : fmt::format(", of {:.4f} its size", found.scale);
  return fmt::format(
      "{} is {:.1f} mm and {:.1f} degrees from where the tracker has it{}; a contact is {} mm from "
      "its surface by the others",
      found.name, 1e3 * offset, turn / kPerDegree, scale, readable(1e3 * found.held_out_rms));
}

std::string format_objects(const std::vector<CalibratedObject>& found, const ObjectsInput& input) {
  std::string text =
      "format: pcavr-calibration/1\nkind: objects\nsource: " + quoted(input.recording.string()) +
      "\nobjects:\n";
  for (const CalibratedObject& object : found) {
    const Pose& T = object.T_tracked_object;
    text += "  - name: " + quoted(object.name) + '\n';
    text += fmt::format("    tracked_to_object: {{t: {}, q: {}}}  # m; x y z w\n",
                        number_list(T.translation()), number_list(T.rotation().coeffs()));
    text +=
        "    unit: " + shortest_decimal(object.mesh_unit) + "  # m, of the mesh's coordinates\n";
    text += "    std: {";
    for (std::size_t i = 0; i < kObjectParameters; ++i) {
      text += (i == 0 ? "" : ", ") + std::string(kParameterNames[i]) + ": " +
              (object.is_observable[i] ? shortest_decimal(object.stds[i]) : "~");
    }
    text += "}  # m, rad, 1 in the mesh's axes; ~: not observable, as stated\n";
    text += "    held_out_rms: " + shortest_decimal(object.held_out_rms) +
            "  # m, of each contact by the others\n";
  }
  return text;
}

}  // namespace pcavr
