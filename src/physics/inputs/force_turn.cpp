// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/force_turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "physics/inputs/signed_permutations.hpp"

namespace pcavr {
namespace {

constexpr int kTurnIterations = 20;
/// Residuals beyond this many stds count less [Cauchy]: a push of which the tracking is wrong.
constexpr double kOutlier = 3.0;
/// Std of a turn before the data: the smallest one is preferred where they do not show it.
constexpr double kPriorStd = 60.0 * kDegree;
// Errors that all contacts share: a tracker's or a table's own turn about z; tilts, by friction at
// the tip of an arm that gives way in the same manner in every contact.
constexpr double kSharedStdAboutZ = 2.0 * kDegree;
constexpr double kSharedTiltStd = 3.0 * kDegree;
constexpr double kSameOrientation = 3.0 * kDegree;  // of the tool in all contacts
// A fault: 4 stds, more than the 1 % by which 8 degrees shorten a force, and half the residuals.
constexpr double kFaultStds = 4.0;
constexpr double kMinFault = 8.0 * kDegree;
constexpr double kExplainedShare = 0.5;
constexpr double kGoodAngle = 4.0 * kDegree;  // of most directions once they are turned back
constexpr double kWrongRms = 45.0 * kDegree;  // as written, which no friction explains
/// Smallest number of contacts for an error: the directions of two contacts fit some rotation
/// whenever their angles are alike.
constexpr std::size_t kMinTurnContacts = 3;
constexpr double kNoteStds = 2.5;
constexpr double kMinNote = 5.0 * kDegree;
/// Gain in the cost that is needed to prefer a turn to the tool's axes, and a mirror to a turn.
constexpr double kGain = 16.0;
constexpr const char* kToolZ = "the tool's z axis";  // about which import can turn forces
constexpr double kNamedAxis = 0.9;  // cosine to an axis, by which the turn is named

/// The rotation that turns the recorded forces into the directions that they must have. The
/// friction at the tip changes the force's direction, too, by as much as the evidence's stds say.
struct ForceTurn {
  Eigen::Matrix3d correction = Eigen::Matrix3d::Identity();  ///< det -1: mirrored
  bool is_in_tool = false;  ///< the correction maps in the tool's axes; else in base
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< [rad] of the force, in those axes
  double angle_std = 0.0;                          ///< [rad] along it
  double stds = 0.0;                               ///< that the turn is off zero
  double rms = 0.0;                                ///< [rad] of the angles that remain
  double rms_as_written = 0.0;                     ///< [rad]
  double middle = 0.0;                             ///< [rad] median of the angles that remain
  double cost = 0.0;                               ///< robust sum of squares over variances
  std::size_t contacts = 0;
};

/// One contact's directions in the axes in which the turn is constant.
struct Pair {
  Eigen::Vector3d force, expected;
  Eigen::Matrix<double, 2, 3> across;  ///< rows: unit vectors across `expected`, over their stds
};

/// Axes of the pairs, and of the force as written.
enum class Axes { base, tool, force_in_tool };

std::vector<Pair> pairs_of(std::span<const ContactEvidence> evidence, Axes axes) {
  std::vector<Pair> pairs;
  for (const ContactEvidence& one : evidence) {
    if (!one.direction) continue;
    const ForceDirection& direction = *one.direction;
    const Eigen::Vector3d& b = direction.expected_base;
    const bool is_press = std::abs(b.z()) > b.head<2>().norm();
    const Eigen::Vector3d level =
        (is_press ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ()).cross(b).normalized();
    Pair pair{direction.force_base, b, {}};
    pair.across.row(0) = level.transpose() / direction.across_std;
    pair.across.row(1) =
        b.cross(level).transpose() / (is_press ? direction.across_std : direction.upward_std);
    if (axes == Axes::force_in_tool) pair.force = *direction.q_base_tool * pair.force;
    if (axes == Axes::tool) {
      const Eigen::Matrix3d R_base_tool = direction.q_base_tool->toRotationMatrix();
      pair.force = R_base_tool.transpose() * pair.force;
      pair.expected = R_base_tool.transpose() * pair.expected;
      pair.across *= R_base_tool;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

/// Angle of the rotation from `expected` to `force` [rad].
double angle_to(const Eigen::Vector3d& force, const Eigen::Vector3d& expected) {
  return std::atan2(force.cross(expected).norm(), force.dot(expected));
}

/// The angle between them in stds, by its two components.
Eigen::Vector2d residual_of(const Pair& pair, const Eigen::Vector3d& force) {
  const Eigen::Vector3d off = force - force.dot(pair.expected) * pair.expected;
  const double sine = off.norm();
  const double angle = angle_to(force, pair.expected);
  if (sine < 1e-12) return pair.across.rowwise().norm() * (angle > 1.0 ? angle : 0.0);
  return pair.across * off * (angle / sine);
}

double weight_of(double squares) { return 1.0 / (1.0 + squares / (kOutlier * kOutlier)); }

double cost_of(const std::vector<Pair>& pairs, const Eigen::Matrix3d& correction) {
  double cost = 0.0;
  for (const Pair& pair : pairs) {
    const double squares = residual_of(pair, correction * pair.force).squaredNorm();
    cost += kOutlier * kOutlier * std::log1p(squares / (kOutlier * kOutlier));
  }
  return cost;
}

/// The rms angle of the pairs [rad], weighted as in the fit.
double rms_of(const std::vector<Pair>& pairs, const Eigen::Matrix3d& correction,
              const std::vector<double>& weights) {
  double sum = 0.0, total = 1e-12;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += weights[i] * std::pow(angle_to(correction * pairs[i].force, pairs[i].expected), 2);
    total += weights[i];
  }
  return std::sqrt(sum / total);
}

Eigen::Vector3d turn_of(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// The nearest rotation, of a mirrored interpretation with its mirror taken off.
Eigen::Vector3d correction_turn(const Eigen::Matrix3d& correction) {
  return turn_of(correction.determinant() > 0.0 ? correction : Eigen::Matrix3d(-correction));
}

struct Fit {
  Eigen::Matrix3d correction = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  std::vector<double> weights = {};
  double cost = 0.0;
};

/// Gauss-Newton on the rotation, with weights by the residuals.
Fit fit_from(const Eigen::Matrix3d& start, const std::vector<Pair>& pairs) {
  Fit fit{.correction = start};
  double squares = 0.0;
  for (int iteration = 0; iteration < kTurnIterations; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() / (kPriorStd * kPriorStd);
    Eigen::Vector3d gradient = normal * correction_turn(fit.correction);
    fit.weights.clear();
    squares = 0.0;
    for (const Pair& pair : pairs) {
      const Eigen::Vector3d force = fit.correction * pair.force;
      const Eigen::Vector2d residual = residual_of(pair, force);
      // A small rotation w changes the force by w x f: along a unit vector e by w . (f x e), where
      // f is about the expected direction.
      Eigen::Matrix<double, 2, 3> by;
      for (int k = 0; k < 2; ++k) {
        by.row(k) = pair.expected.cross(Eigen::Vector3d(pair.across.row(k))).transpose();
      }
      const double weight = weight_of(residual.squaredNorm());
      normal += weight * by.transpose() * by;
      gradient += weight * by.transpose() * residual;
      squares += weight * residual.squaredNorm();
      fit.weights.push_back(weight);
    }
    const Eigen::Vector3d step = -normal.ldlt().solve(gradient);
    const double angle = step.norm();
    if (angle > 0.0) {
      fit.correction = Eigen::AngleAxisd(angle, step / angle) * fit.correction;
    }
    fit.covariance = normal.inverse();
    if (angle < 1e-9) break;
  }
  const double freedoms = 2.0 * static_cast<double>(pairs.size()) - 3.0;
  if (freedoms > 0.0) fit.covariance *= std::max(1.0, squares / freedoms);
  fit.cost = cost_of(pairs, fit.correction) +
             std::pow(correction_turn(fit.correction).norm() / kPriorStd, 2);
  return fit;
}

/// The best of all starts; a mirrored one only where no rotation is nearly as good.
Fit best_fit(const std::vector<Pair>& pairs) {
  Fit best = fit_from(Eigen::Matrix3d::Identity(), pairs);
  std::optional<Fit> mirrored;
  for (const Eigen::Matrix3d& start : signed_permutations()) {
    Fit fit = fit_from(start, pairs);
    const bool is_mirrored = start.determinant() < 0.0;
    if (is_mirrored && (!mirrored || fit.cost < mirrored->cost - 1e-9)) mirrored = std::move(fit);
    if (!is_mirrored && fit.cost < best.cost - 1e-9) best = std::move(fit);
  }
  return mirrored && mirrored->cost < best.cost - kGain ? *mirrored : best;
}

/// Errors that the contacts share, in the axes of the fit.
Eigen::Matrix3d shared_covariance(const Eigen::Matrix3d& R_base_axes) {
  const Eigen::Vector3d stds(kSharedTiltStd, kSharedTiltStd, kSharedStdAboutZ);
  return R_base_axes.transpose() * stds.cwiseAbs2().asDiagonal() * R_base_axes;
}

ForceTurn turn_in(const std::vector<Pair>& pairs, const Eigen::Matrix3d& R_base_axes) {
  const Fit fit = best_fit(pairs);
  ForceTurn found{.correction = fit.correction, .contacts = pairs.size()};
  found.turn = -correction_turn(fit.correction);
  const double angle = found.turn.norm();
  const Eigen::Vector3d axis =
      angle > 0.0 ? Eigen::Vector3d(found.turn / angle) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  const Eigen::Matrix3d covariance = fit.covariance + shared_covariance(R_base_axes);
  found.angle_std = std::sqrt(axis.dot(covariance * axis));
  found.cost = fit.cost;
  // A turn about nearly the direction of all forces changes them little, however large it is: it is
  // no more certain than it makes the directions agree.
  const double gain = cost_of(pairs, Eigen::Matrix3d::Identity()) - fit.cost;
  found.stds = std::min(std::sqrt(found.turn.dot(covariance.ldlt().solve(found.turn))),
                        std::sqrt(std::max(gain, 0.0)));
  found.rms = rms_of(pairs, fit.correction, fit.weights);
  found.rms_as_written = rms_of(pairs, Eigen::Matrix3d::Identity(), fit.weights);
  std::vector<double> angles;
  for (const Pair& pair : pairs)
    angles.push_back(angle_to(fit.correction * pair.force, pair.expected));
  found.middle = median(std::move(angles));
  return found;
}

/// "the tool's z axis", "(0.12, 0.34, -0.93) in base", and the sign of the turn about a named one.
std::string axis_text(const Eigen::Vector3d& axis, const char* owner, double& angle) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(axis[k]) < kNamedAxis) continue;
    if (axis[k] < 0.0) angle = -angle;
    return std::string(owner) + "'s " + "xyz"[k] + " axis";
  }
  return fmt::format("the axis ({:.2f}, {:.2f}, {:.2f}) of {}", axis.x(), axis.y(), axis.z(),
                     owner);
}

struct TurnText {
  std::string text, axis;
  double degrees = 0.0;  ///< about the axis
};

TurnText describe_turn(const ForceTurn& found,
                       const std::optional<Eigen::Quaterniond>& q_base_tool) {
  Eigen::Vector3d turn = found.turn;
  if (!found.is_in_tool && q_base_tool) turn = q_base_tool->conjugate() * turn;
  TurnText result;
  result.degrees = turn.norm() / kDegree;
  result.axis = axis_text(turn.normalized(), q_base_tool ? "the tool" : "base", result.degrees);
  result.text = fmt::format("by {:.1f} +- {:.1f} degrees about {}", result.degrees,
                            found.angle_std / kDegree, result.axis);
  return result;
}

std::string residuals_text(const ForceTurn& found) {
  return fmt::format("rms angle {:.1f} degrees over {} contacts, as written {:.1f}",
                     found.rms / kDegree, found.contacts, found.rms_as_written / kDegree);
}

/// Axes of which each is one of the recorded, perhaps reversed, where that is the correction, or a
/// mirrored one is about that.
std::optional<Eigen::Matrix3d> permuted_axes(const Eigen::Matrix3d& correction) {
  Eigen::Matrix3d nearest = Eigen::Matrix3d::Identity();
  double trace = -3.0;
  for (const Eigen::Matrix3d& axes : signed_permutations()) {
    if (axes.determinant() * correction.determinant() < 0.0) continue;
    const double of_rest = (correction * axes.transpose()).trace();
    if (of_rest > trace) trace = of_rest, nearest = axes;
  }
  const double rest = turn_of(correction * nearest.transpose()).norm();
  const bool is_near = correction.determinant() < 0.0 || rest < kMinFault;
  if (nearest.isIdentity() || !is_near) return std::nullopt;
  return nearest;
}

/// Other axes that explain the directions as well as a turn: of pushes that are all alike, a swap
/// of two axes and a turn have the same effect.
std::optional<Eigen::Matrix3d> axes_that_fit(std::span<const ContactEvidence> evidence,
                                             const ForceTurn& found) {
  const std::vector<Pair> pairs = pairs_of(evidence, found.is_in_tool ? Axes::tool : Axes::base);
  std::optional<Eigen::Matrix3d> best;
  double cost = found.cost + kGain;
  for (const bool is_mirrored : {false, true}) {
    for (const Eigen::Matrix3d& axes : signed_permutations()) {
      if (axes.isIdentity() || (axes.determinant() < 0.0) != is_mirrored) continue;
      const double of_axes = cost_of(pairs, axes);
      if (of_axes < cost) cost = of_axes, best = axes;
    }
    if (best) return best;
  }
  return best;
}

std::optional<ForceTurn> find_force_turn(std::span<const ContactEvidence> evidence) {
  const std::vector<Pair> pairs = pairs_of(evidence, Axes::base);
  if (pairs.empty()) return std::nullopt;
  ForceTurn in_base = turn_in(pairs, Eigen::Matrix3d::Identity());
  // A turn in the tool's axes differs from one in base only where the tool's orientation changes.
  std::optional<Eigen::Quaterniond> first;
  bool is_same = true;
  for (const ContactEvidence& one : evidence) {
    if (!one.direction) continue;
    const std::optional<Eigen::Quaterniond>& q_base_tool = one.direction->q_base_tool;
    if (!q_base_tool) return in_base;
    if (!first) first = q_base_tool;
    is_same &= first->angularDistance(*q_base_tool) < kSameOrientation;
  }
  if (is_same) return in_base;
  ForceTurn in_tool = turn_in(pairs_of(evidence, Axes::tool), first->toRotationMatrix());
  in_tool.is_in_tool = true;
  return in_tool.cost < in_base.cost ? in_tool : in_base;
}

/// The option that turns the forces back, where there is one.
std::string import_text(const TurnText& turn) {
  if (turn.axis != kToolZ) return "";
  return fmt::format("; pcavr import has --wrench-turn {:.1f}", -turn.degrees);
}

Error turn_error(const ForceTurn& found, const std::optional<Eigen::Quaterniond>& q_base_tool,
                 bool is_in_tool_axes, const std::optional<Eigen::Matrix3d>& axes_that_fit) {
  Error error{.message = "", .file = "wrench.csv", .hint = "write it in base axes"};
  const std::string agreement =
      "it points along the motion of the pushed objects, or into the faces that the tool touches "
      "(" +
      residuals_text(found) + ")";
  if (is_in_tool_axes) {
    error.message =
        "the force is in the tool's axes: rotated by the tool's orientation " + agreement;
    return error;
  }
  if (const auto axes = permuted_axes(found.correction)) {
    error.message = "the force is in other axes than the tool's motion: read as, for example, " +
                    components_text(*axes) + " " + agreement;
    return error;
  }
  const TurnText text = describe_turn(found, q_base_tool);
  if (axes_that_fit) {
    error.message = "the force is in other axes than the tool's motion: read as, for example, " +
                    components_text(*axes_that_fit) + ", or turned back " + text.text + ", " +
                    agreement;
    return error;
  }
  error.message = "the force is turned " + text.text + ": turned back " + agreement;
  error.hint = fmt::format("is the sensor mounted so? Turn its forces by {:.1f} degrees about {}",
                           -text.degrees, text.axis);
  error.hint += import_text(text);
  return error;
}

/// Whether the tool's orientation explains the directions as well as the turn that was found.
bool is_in_tool_axes(std::span<const ContactEvidence> evidence, const ForceTurn& found,
                     const std::optional<Eigen::Quaterniond>& q_base_tool) {
  if (!q_base_tool || q_base_tool->angularDistance(Eigen::Quaterniond::Identity()) < kMinFault) {
    return false;
  }
  const std::vector<Pair> pairs = pairs_of(evidence, Axes::force_in_tool);
  return cost_of(pairs, Eigen::Matrix3d::Identity()) < found.cost + kGain;
}

}  // namespace

TurnFinding state_force_turn(std::span<const ContactEvidence> evidence) {
  TurnFinding finding;
  const std::optional<ForceTurn> found = find_force_turn(evidence);
  if (!found) return finding;
  const std::optional<Eigen::Quaterniond> q_base_tool =
      std::find_if(evidence.begin(), evidence.end(), [](const ContactEvidence& one) {
        return one.direction.has_value();
      })->direction->q_base_tool;
  const double angle = found->turn.norm();
  const bool is_mirrored = found->correction.determinant() < 0.0;
  const bool is_explained = found->rms < kExplainedShare * found->rms_as_written;
  const bool is_certain = is_mirrored || (found->stds >= kFaultStds && angle >= kMinFault);
  // Where a body turns about the tip, as at a corner, its friction is not along the tip's motion:
  // then no turn makes the directions agree well.
  const bool is_good =
      is_mirrored || found->middle < kGoodAngle || found->rms_as_written > kWrongRms;
  if (is_explained && is_certain && is_good && found->contacts >= kMinTurnContacts) {
    finding.error = turn_error(*found, q_base_tool, is_in_tool_axes(evidence, *found, q_base_tool),
                               axes_that_fit(evidence, *found));
  } else if (!is_mirrored && found->stds >= kNoteStds && angle >= kMinNote) {
    const TurnText text = describe_turn(*found, q_base_tool);
    finding.noted_angle = angle + found->angle_std;
    finding.note = "the force seems turned " + text.text + " (" + residuals_text(*found) +
                   "): check how the sensor is mounted" + import_text(text) +
                   "; or the tip slides along the faces";
  }
  return finding;
}

}  // namespace pcavr
