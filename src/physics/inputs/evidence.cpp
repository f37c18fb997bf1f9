// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/friction/standing.hpp"

namespace pcavr {
namespace {

/// A contact is loaded above this share of its peak force, or slides at about that force.
constexpr double kLoaded = 0.8;
// Steps of the motion [s]: long compared with the tip's noise, short enough for a curved path.
constexpr double kMinMotionStep = 0.02;
constexpr double kMaxMotionStep = 0.10;
constexpr double kStepsOfContact = 6.0;
/// Six to ten times the position noise of marker tracking.
constexpr double kMinDisplacement = 0.002;  // [m]
constexpr double kDensity = 700.0;          // [kg/m^3] of a body that was not weighed: wood
/// Range of the motion that counts, as shares of the displacement: at its ends the object may not
/// slide.
constexpr double kMotionBegins = 0.1;
constexpr double kMotionEnds = 0.9;

// Std of the angle between the force on a sliding object and the motion of its centre of pressure:
// friction that depends on the direction or the place, 1 to 3 degrees in simulated plants ...
constexpr double kStraightStd = 4.0 * kDegree;
/// ... and more with the share of rotation in the motion: of real blocks on few points 10 degrees
/// at a half.
constexpr double kTurningStd = 20.0 * kDegree;
/// Std of the pressure's shift ahead, as a share of it, by what the support is, ...
constexpr double kShiftStd = 0.3;
/// ... and where the weight is not known, of which the force may be a tenth or all.
constexpr double kUnknownShiftStd = 1.0;
/// Largest force over the weight that slides a body: beyond, the weight or the force is wrong.
constexpr double kMaxCoefficient = 1.2;
/// Std of the force's angle on an object that rests or is not tracked: a friction coefficient of
/// 0.2 at the tip.
constexpr double kConeStd = 11.0 * kDegree;
/// Std of the angle in a press along the normal, and upward in a push: little of the friction at
/// the tip is mobilised.
constexpr double kNormalStd = 6.0 * kDegree;
constexpr double kUnknownStd = 60.0 * kDegree;    // at an edge
constexpr double kOnFace = 0.98;                  // cosine to the face's normal: not at an edge
constexpr double kMaxSidewaysPress = 0.1;         // of the tip's way along the normal, as it loads
constexpr double kMinPressDisplacement = 0.0002;  // [m] several times the tip's noise

/// The samples from the first touch to the last one that is still loaded.
struct LoadedRange {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< one past the last
};

LoadedRange loaded_range(const Contact& contact) {
  LoadedRange range;
  while (range.begin < contact.t.size() && contact.t[range.begin] < contact.begin) ++range.begin;
  for (std::size_t i = range.begin; i < contact.force_base.size(); ++i) {
    if (contact.t[i] > contact.end) break;
    if (contact.force_base[i].norm() >= kLoaded * contact.peak_force) range.end = i + 1;
  }
  return range;
}

const Eigen::Quaterniond& tool_axes_at(const InputSeries& series, double t) {
  const auto after = std::lower_bound(series.t_tool.begin(), series.t_tool.end(), t);
  const auto i = std::min(static_cast<std::size_t>(after - series.t_tool.begin()),
                          series.q_base_tool.size() - 1);
  return series.q_base_tool[i];
}

void add_forces(const InputSeries& series, const Contact& contact, const LoadedRange& range,
                const PathView& tip, ContactEvidence& evidence) {
  const std::vector<double>& t = contact.t;
  const double step = std::clamp((t[range.end - 1] - t[range.begin]) / kStepsOfContact,
                                 kMinMotionStep, kMaxMotionStep);
  for (std::size_t from = range.begin, to; from + 1 < range.end; from = to) {
    Eigen::Vector3d sum = contact.force_base[from];
    for (to = from + 1; to + 1 < range.end && t[to] < t[from] + step; ++to) {
      sum += contact.force_base[to];
    }
    const Eigen::Vector3d force = sum / static_cast<double>(to - from);
    const Eigen::Vector3d motion = tip.at(t[to]) - tip.at(t[from]);
    evidence.force_base += sum;
    evidence.force_motion += force * motion.transpose();
    evidence.effort += force.norm() * motion.norm();
    if (series.q_base_tool.empty()) continue;
    const Eigen::Matrix3d R_base_tool = tool_axes_at(series, t[from]).toRotationMatrix();
    evidence.tool_force_base += R_base_tool * sum;
    evidence.tool_work += (R_base_tool * force).dot(motion);
  }
}

/// A motion in the plane while a push is loaded, against the force.
struct MotionByForce {
  double along = 0.0;   ///< [N m] sum of F dx
  double across = 0.0;  ///< [N m] sum of F x dx: positive where the motion is to the left

  void add(const Eigen::Vector3d& force, const Eigen::Vector3d& way) {
    along += force.head<2>().dot(way.head<2>());
    across += force.x() * way.y() - force.y() * way.x();
  }
  [[nodiscard]] double angle() const { return std::atan2(across, along); }
};

struct CentreMotion {
  bool is_weight_known = false;
  MotionByForce of_mass;
  /// Of the point at which friction acts: ahead of the centre of mass, so that it moves elsewhere
  /// where the object turns.
  MotionByForce of_pressure;
  double moved = 0.0;           ///< [m] of the centre of mass
  double rotation_share = 0.0;  ///< of the motion at the tip

  /// [rad] By which the motion is elsewhere.
  [[nodiscard]] double angle_of_shift() const {
    return std::remainder(of_pressure.angle() - of_mass.angle(), 2.0 * std::numbers::pi);
  }
};

CentreMotion centre_motion(const InputSeries& series, const Contact& contact,
                           const LoadedRange& range, const PathView& tip, const BodyPoses& poses) {
  const std::vector<double>& t = contact.t;
  const InputBody& body = series.bodies[*contact.object];
  const Eigen::Vector3d& centre = body.model->centre_of_mass_object;
  CentreMotion motion;
  Pose before = poses.at(*contact.object, t[range.begin]);
  const Pose first = before;
  const double support = support_height(*body.model, first);
  std::optional<double> weight;
  if (body.mass && contact.peak_force < kMaxCoefficient * *body.mass * kStandardGravity)
    weight = *body.mass * kStandardGravity;
  motion.is_weight_known = weight.has_value();
  for (std::size_t from = range.begin, to; from + 1 < range.end; from = to) {
    Eigen::Vector3d sum = contact.force_base[from];
    for (to = from + 1; to + 1 < range.end && t[to] < t[from] + kMaxMotionStep; ++to) {
      sum += contact.force_base[to];
    }
    const Pose after = poses.at(*contact.object, t[to]);
    const Eigen::Vector3d way = after * centre - before * centre;
    const Eigen::Vector3d force = sum / static_cast<double>(to - from);
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    shift.head<2>() = centre_of_pressure(force.head<2>(), tip.at(t[from]).z() - support, weight);
    const Eigen::Matrix3d turn = (after.rotation() * before.rotation().conjugate()).matrix();
    motion.of_mass.add(force, way);
    motion.of_pressure.add(force, way + turn * shift - shift);
    before = after;
  }
  motion.moved = (before * centre - first * centre).head<2>().norm();
  const double lever = (tip.at(t[range.begin]) - first * centre).head<2>().norm();
  const double turned = lever * first.rotation().angularDistance(before.rotation());
  motion.rotation_share = turned / std::max(std::hypot(motion.moved, turned), 1e-9);
  return motion;
}

/// The tip's way sideways over that along `inward_base`, from the touch to the largest force.
double sideways_share(const Contact& contact, const LoadedRange& range, const PathView& tip,
                      const Eigen::Vector3d& inward_base) {
  std::size_t peak = range.begin;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    if (contact.force_base[i].squaredNorm() > contact.force_base[peak].squaredNorm()) peak = i;
  }
  const Eigen::Vector3d way = tip.at(contact.t[peak]) - tip.at(contact.t[range.begin]);
  const double deep = way.dot(inward_base);
  if (deep < kMinPressDisplacement) return 1.0;
  return (way - deep * inward_base).norm() / deep;
}

/// `direction_base` turned about z, with the slope of `inward_base`.
Eigen::Vector3d turned(const Eigen::Vector3d& direction_base, double angle,
                       const Eigen::Vector3d& inward_base) {
  const Eigen::Vector2d level =
      Eigen::Rotation2Dd(angle) * Eigen::Vector2d(direction_base.head<2>().normalized());
  const double across = inward_base.head<2>().norm();
  return {across * level.x(), across * level.y(), inward_base.z()};
}

std::optional<ForceDirection> direction_of(const InputSeries& series, const Contact& contact,
                                           const LoadedRange& range, const PathView& tip,
                                           const BodyPoses& poses,
                                           const ContactEvidence& evidence) {
  if (!contact.left_out.empty() || contact.impact) return std::nullopt;
  const Eigen::Vector3d& inward = evidence.inward_base;
  ForceDirection direction{.force_base = evidence.force_base.normalized(),
                           .expected_base = inward,
                           .across_std = kConeStd,
                           .upward_std = kNormalStd};
  const double begin = contact.begin;
  if (!series.q_base_tool.empty()) direction.q_base_tool = tool_axes_at(series, begin);
  const Pose T_base_object = poses.at(*contact.object, begin);
  const bool is_on_face = inward.dot(T_base_object.rotation() * contact.normal_object) < -kOnFace;
  if (std::abs(inward.z()) > inward.head<2>().norm()) {
    if (!is_on_face || sideways_share(contact, range, tip, inward) > kMaxSidewaysPress) {
      return std::nullopt;
    }
    direction.across_std = kNormalStd;
    return direction;
  }
  if (!is_on_face) direction.upward_std = kUnknownStd;
  if (!poses.is_tracked(*contact.object)) {
    // One that is pushed without tracking lies where earlier pushes seem to have moved it: the tip
    // may be at a neighbouring face.
    const bool is_certain = is_on_face && !series.bodies[*contact.object].is_movable;
    if (!is_certain || sideways_share(contact, range, tip, inward) > kMaxSidewaysPress) {
      return std::nullopt;
    }
    direction.is_by_face = true;
    return direction;
  }
  const CentreMotion motion = centre_motion(series, contact, range, tip, poses);
  if (motion.moved < kMinDisplacement) return std::nullopt;
  direction.expected_base = turned(direction.force_base, motion.of_pressure.angle(), inward);
  const double shift_std = motion.is_weight_known ? kShiftStd : kUnknownShiftStd;
  direction.across_std = std::hypot(kStraightStd, kTurningStd * motion.rotation_share,
                                    shift_std * motion.angle_of_shift());
  return direction;
}

/// Contacts with one face that share their error count as one.
void widen_by_face(std::span<const Contact> contacts, std::vector<ContactEvidence>& all) {
  constexpr double kMinNormalCosine = 0.98;  // cosine
  std::vector<double> counts;
  for (const ContactEvidence& one : all) {
    const Contact& contact = contacts[one.contact];
    counts.push_back(static_cast<double>(
        std::count_if(all.begin(), all.end(), [&](const ContactEvidence& other) {
          const Contact& with = contacts[other.contact];
          return other.direction && other.direction->is_by_face && with.object == contact.object &&
                 with.normal_object.dot(contact.normal_object) > kMinNormalCosine;
        })));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].direction || !all[i].direction->is_by_face) continue;
    all[i].direction->across_std *= std::sqrt(counts[i]);
  }
}

/// Displacement of the object from the beginning of a contact until `t`.
double displacement_until(const Contact& contact, const BodyPoses& poses, double t) {
  if (!poses.is_tracked(*contact.object)) return displacement_at(contact, t);
  return translation_distance(poses.at(*contact.object, contact.begin),
                              poses.at(*contact.object, t));
}

double cosine(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double norms = a.norm() * b.norm();
  return norms > 0.0 ? a.dot(b) / norms : 0.0;
}

double mass_or_bound(const InputBody& body) {
  return body.mass ? *body.mass : kDensity * body.model->volume;
}

}  // namespace

std::vector<ContactEvidence> gather_evidence(const InputSeries& series,
                                             std::span<const Contact> contacts, const PathView& tip,
                                             const BodyPoses& poses) {
  std::vector<ContactEvidence> all;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& contact = contacts[i];
    if (!contact.object || contact.force_base.empty()) continue;
    const LoadedRange range = loaded_range(contact);
    if (range.end < range.begin + 2) continue;
    ContactEvidence evidence{.contact = i};
    const double t = contact.begin;
    evidence.inward_base =
        poses.touch(*contact.object, t, tip.at(t), series.tool_radius).inward_base;
    add_forces(series, contact, range, tip, evidence);
    evidence.direction = direction_of(series, contact, range, tip, poses, evidence);
    all.push_back(evidence);
  }
  widen_by_face(contacts, all);
  return all;
}

double inward_cosine(const ContactEvidence& evidence) {
  return cosine(evidence.force_base, evidence.inward_base);
}

DirectionAgreement agreement_of(std::span<const ContactEvidence> evidence,
                                const Eigen::Matrix3d& axes) {
  DirectionAgreement sum;
  double effort = 0.0;
  for (const ContactEvidence& one : evidence) {
    sum.inward += cosine(axes * one.force_base, one.inward_base);
    sum.motion += (axes * one.force_motion).trace();
    effort += one.effort;
  }
  return {sum.inward / std::max(static_cast<double>(evidence.size()), 1.0),
          effort > 0.0 ? sum.motion / effort : 0.0};
}

DirectionAgreement agreement_in_tool_axes(std::span<const ContactEvidence> evidence) {
  DirectionAgreement sum;
  double effort = 0.0;
  for (const ContactEvidence& one : evidence) {
    sum.inward += cosine(one.tool_force_base, one.inward_base);
    sum.motion += one.tool_work;
    effort += one.effort;
  }
  return {sum.inward / std::max(static_cast<double>(evidence.size()), 1.0),
          effort > 0.0 ? sum.motion / effort : 0.0};
}

std::optional<double> friction_ratio(const InputSeries& series, const Contact& contact,
                                     const BodyPoses& poses) {
  if (!contact.object || contact.kind == ContactKind::press) return std::nullopt;
  const double mass = mass_or_bound(series.bodies[*contact.object]);
  const double moved = displacement_until(contact, poses, contact.end);
  if (!(mass > 0.0) || moved < kMinDisplacement) return std::nullopt;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < contact.force_base.size(); ++i) {
    if (contact.t[i] < contact.begin || contact.t[i] > contact.end) continue;
    const double done = displacement_until(contact, poses, contact.t[i]) / moved;
    if (done < kMotionBegins || done > kMotionEnds) continue;
    const Eigen::Vector3d& force = contact.force_base[i];
    // A tip that presses down adds to the normal force on the support.
    ratios.push_back(force.head<2>().norm() /
                     (mass * kStandardGravity + std::max(0.0, -force.z())));
  }
  if (ratios.empty()) return std::nullopt;
  return median(std::move(ratios));
}

}  // namespace pcavr
