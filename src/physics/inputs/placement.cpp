// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <fmt/format.h>

namespace pcavr {
namespace {

/// [m] between tip and surface when the force begins: more than the errors of poses and radius.
constexpr double kMaxGapAtTouch = 0.015;
/// Minimum cosine of the force to the direction into the surface, as for its axes.
constexpr double kIntoSurface = 0.5;
/// One contact may be with an unknown object that happens to lie where the other interpretation has
/// the body.
constexpr std::size_t kMinExplained = 2;
/// Sizes by which a mesh is wrong in practice: its unit, and a radius for a diameter.
constexpr std::array<double, kMeshInterpretations> kMeshFactors{1e-3, 1e-2,       0.1,  0.5,
                                                                2.0,  1.0 / 25.4, 25.4, 1e3};
struct PoseUnit {
  const char* name;
  double metres;
};
constexpr std::array<PoseUnit, kPoseInterpretations> kPoseUnits{
    {{"millimetres", 1e-3}, {"centimetres", 1e-2}}};
// An object that is pushed over a support does not tilt: tracking is more certain than this [rad],
// and the other order of the quaternion must remove most of it.
constexpr double kMinTilt = 0.10;
constexpr double kMaxShareOfTilt = 0.2;
// The pose in the scene is that of the recording's start, or nearly: [rad], [m].
constexpr double kMinTurnAtStart = 0.8;
constexpr double kMaxTurnIfReordered = 0.2;
constexpr double kMaxDistanceAtStart = 1.0;  // more than an arm pushes an object
// Exchanged tracks: near another body's pose in the scene, and far from its own [m].
constexpr double kAtStart = 0.02;
constexpr double kFarFromStart = 0.05;
// An object that moves by so much in a contact was touched; the tip is not at it [m].
constexpr double kMovedByContact = 0.01;
constexpr double kNotTouched = 0.03;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The orientation whose components, in the order w x y z, were read as x y z w.
Eigen::Quaterniond if_w_first(const Eigen::Quaterniond& read) {
  return {read.x(), read.y(), read.z(), read.w()};
}

/// The base's vertical in the object's frame.
Eigen::Vector3d vertical_object(const Eigen::Quaterniond& q_base_object) {
  return q_base_object.conjugate() * Eigen::Vector3d::UnitZ();
}

BodyPlacement tracked_placement(const InputBody& body) {
  BodyPlacement result;
  if (body.tracked.empty()) return result;
  result.is_tracked = true;
  const Eigen::Quaterniond& first = body.tracked.front().T_base_object.rotation();
  const Eigen::Vector3d up = vertical_object(first);
  const Eigen::Vector3d up_if_w_first = vertical_object(if_w_first(first));
  for (const TrackedPose& pose : body.tracked) {
    const Eigen::Quaterniond& q = pose.T_base_object.rotation();
    result.tilt = std::max(result.tilt, angle_between(up, vertical_object(q)));
    result.tilt_if_w_first = std::max(result.tilt_if_w_first,
                                      angle_between(up_if_w_first, vertical_object(if_w_first(q))));
  }
  const Eigen::Quaterniond& in_scene = body.T_base_object.rotation();
  result.turn_at_start = in_scene.angularDistance(first);
  result.turn_if_w_first = in_scene.angularDistance(if_w_first(first));
  result.distance_at_start =
      translation_distance(body.T_base_object, body.tracked.front().T_base_object);
  return result;
}

void find_nearest_at_start(const std::vector<InputBody>& bodies, std::size_t body,
                           BodyPlacement& result) {
  if (!result.is_tracked) return;
  result.nearest_at_start = body;
  result.nearest_distance = result.distance_at_start;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double distance =
        translation_distance(bodies[i].T_base_object, bodies[body].tracked.front().T_base_object);
    if (distance >= result.nearest_distance) continue;
    result.nearest_at_start = i;
    result.nearest_distance = distance;
  }
}

/// The only body that moves in a contact must be the one that is touched.
void check_moved_body(const InputSeries& series, const Contact& contact,
                      const Eigen::Vector3d& p_base_tip, const BodyPoses& poses,
                      BodyPlacements& result) {
  const double begin = contact.begin;
  std::optional<std::size_t> moved_body;
  double moved = 0.0;
  for (std::size_t i = 0; i < series.bodies.size(); ++i) {
    if (!poses.is_tracked(i)) continue;
    const double distance = translation_distance(poses.at(i, begin), poses.at(i, contact.end));
    if (distance < kMovedByContact) continue;
    if (moved_body) return;
    moved_body = i;
    moved = distance;
  }
  if (!moved_body) return;
  const double gap = poses.touch(*moved_body, begin, p_base_tip, series.tool_radius).gap;
  BodyPlacement& body = result.bodies[*moved_body];
  if (gap < kNotTouched || moved < body.moved_untouched) return;
  body.moved_untouched = moved;
  body.gap_untouched = gap;
  body.t_untouched = begin;
}

bool is_into(const Touch& touch, const Contact& contact) {
  return std::abs(touch.gap) < kMaxGapAtTouch &&
         touch.inward_base.dot(contact.direction_base) >= kIntoSurface;
}

/// The touch of a body whose mesh is `factor` times as large.
Touch scaled_touch(const BodySurface& surface, const Pose& T_base_object,
                   const Eigen::Vector3d& p_base_tip, double tool_radius, double factor) {
  const Eigen::Vector3d p_object = (T_base_object.inverse() * p_base_tip) / factor;
  Touch touch = surface.touch(Pose(), p_object, tool_radius / factor);
  touch.gap *= factor;
  touch.inward_base = T_base_object.rotation() * touch.inward_base;
  return touch;
}

void explain(const InputSeries& series, const Contact& contact, const Eigen::Vector3d& p_base_tip,
             const BodyPoses& poses, std::size_t body, BodyPlacement& result) {
  const Pose T_base_object = poses.at(body, contact.begin);
  for (std::size_t k = 0; k < kMeshFactors.size(); ++k) {
    const Touch touch = scaled_touch(poses.surface(body), T_base_object, p_base_tip,
                                     series.tool_radius, kMeshFactors[k]);
    result.by_mesh[k] += is_into(touch, contact) ? 1 : 0;
  }
  for (std::size_t k = 0; k < kPoseUnits.size(); ++k) {
    const Pose scaled(T_base_object.rotation(), kPoseUnits[k].metres * T_base_object.translation());
    const Touch touch = poses.surface(body).touch(scaled, p_base_tip, series.tool_radius);
    result.by_poses[k] += is_into(touch, contact) ? 1 : 0;
  }
}

/// The number of contacts elsewhere that bodies without a touch explain, and the names of these
/// bodies.
struct Explanation {
  std::size_t contacts = 0;
  std::string names = {};
};

template <typename CountOf>
Explanation explained_by(const std::vector<InputBody>& bodies, const BodyPlacements& placement,
                         const CountOf& count_of) {
  Explanation result;
  for (std::size_t i = 0; i < placement.bodies.size(); ++i) {
    const BodyPlacement& body = placement.bodies[i];
    if (body.touches > 0 || count_of(body) == 0) continue;
    result.contacts += count_of(body);
    result.names += (result.names.empty() ? "" : ", ") + bodies[i].name;
  }
  return result;
}

bool is_decisive(const Explanation& explanation, const BodyPlacements& placement) {
  return explanation.contacts >= kMinExplained && 2 * explanation.contacts >= placement.elsewhere;
}

std::string contacts_text(const Explanation& explanation, const BodyPlacements& placement) {
  return fmt::format("{} of {} contacts, and as written in none", explanation.contacts,
                     placement.elsewhere);
}

std::optional<InputFault> mesh_fault(const std::vector<InputBody>& bodies,
                                     const BodyPlacements& placement) {
  Explanation best;
  double factor = 1.0;
  for (std::size_t k = 0; k < kMeshFactors.size(); ++k) {
    const Explanation found =
        explained_by(bodies, placement, [k](const BodyPlacement& body) { return body.by_mesh[k]; });
    if (found.contacts > best.contacts) best = found, factor = kMeshFactors[k];
  }
  if (!is_decisive(best, placement)) return std::nullopt;
  return InputFault{
      InputFaultKind::mesh_size,
      {.message = fmt::format("the mesh of {} has another size than the object: {:.4g} times as "
                              "large, its surface is where the force begins in {}",
                              best.names, factor, contacts_text(best, placement)),
       .file = "recording.yaml",
       .place = "objects",
       .hint = "write its mesh in metres, at the object's size"}};
}

std::optional<InputFault> pose_unit_fault(const std::vector<InputBody>& bodies,
                                          const BodyPlacements& placement) {
  for (std::size_t k = 0; k < kPoseUnits.size(); ++k) {
    const Explanation found = explained_by(
        bodies, placement, [k](const BodyPlacement& body) { return body.by_poses[k]; });
    if (!is_decisive(found, placement)) continue;
    return InputFault{
        InputFaultKind::body_poses,
        {.message = fmt::format("the poses of {} are in {}: with that unit, its surface is where "
                                "the force begins in {}",
                                found.names, kPoseUnits[k].name, contacts_text(found, placement)),
         .file = "recording.yaml",
         .place = "objects",
         .hint = "write the tracked poses, and the pose in the manifest, in metres"}};
  }
  return std::nullopt;
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::optional<InputFault> quaternion_fault(const std::string& name, const BodyPlacement& body) {
  const bool tilts = body.tilt > kMinTilt && body.tilt_if_w_first < kMaxShareOfTilt * body.tilt;
  const bool turns =
      body.turn_at_start > kMinTurnAtStart && body.turn_if_w_first < kMaxTurnIfReordered;
  if (!body.is_tracked || (!tilts && !turns)) return std::nullopt;
  const std::string seen =
      tilts ? fmt::format("the object tilts by {:.0f} degrees, and by {:.0f} with w first",
                          degrees(body.tilt), degrees(body.tilt_if_w_first))
            : fmt::format(
                  "the first one is turned by {:.0f} degrees from the object's pose in the "
                  "scene, and by {:.0f} with w first",
                  degrees(body.turn_at_start), degrees(body.turn_if_w_first));
  return InputFault{InputFaultKind::body_poses,
                    {.message = "the quaternions of " + name + " begin with w: " + seen,
                     .file = "tracked/objects/" + name + "/tracked.txt",
                     .hint = "write qx qy qz qw"}};
}

}  // namespace

void BodyPlacement::add(const BodyPlacement& later) {
  touches += later.touches;
  min_distance = std::min(min_distance, later.min_distance);
  for (std::size_t k = 0; k < by_mesh.size(); ++k) by_mesh[k] += later.by_mesh[k];
  for (std::size_t k = 0; k < by_poses.size(); ++k) by_poses[k] += later.by_poses[k];
  if (!is_tracked && later.is_tracked) {
    turn_at_start = later.turn_at_start;
    turn_if_w_first = later.turn_if_w_first;
    distance_at_start = later.distance_at_start;
    nearest_at_start = later.nearest_at_start;
    nearest_distance = later.nearest_distance;
  }
  if (later.moved_untouched > moved_untouched) {
    moved_untouched = later.moved_untouched;
    gap_untouched = later.gap_untouched;
    t_untouched = later.t_untouched;
  }
  is_tracked = is_tracked || later.is_tracked;
  tilt = std::max(tilt, later.tilt);
  tilt_if_w_first = std::max(tilt_if_w_first, later.tilt_if_w_first);
}

void BodyPlacements::add(const BodyPlacements& later) {
  contacts += later.contacts;
  elsewhere += later.elsewhere;
  bodies.resize(later.bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].add(later.bodies[i]);
}

BodyPlacements placement_of(const InputSeries& series, std::span<const Contact> contacts,
                            const PathView& tip, const BodyPoses& poses) {
  BodyPlacements result;
  for (std::size_t i = 0; i < series.bodies.size(); ++i) {
    result.bodies.push_back(tracked_placement(series.bodies[i]));
    find_nearest_at_start(series.bodies, i, result.bodies.back());
  }
  for (const Contact& contact : contacts) {
    if (contact.force_base.empty()) continue;
    ++result.contacts;
    const Eigen::Vector3d p_base_tip = tip.at(contact.begin);
    check_moved_body(series, contact, p_base_tip, poses, result);
    bool is_elsewhere = true;
    for (std::size_t i = 0; i < series.bodies.size(); ++i) {
      const Touch touch = poses.touch(i, contact.begin, p_base_tip, series.tool_radius);
      double& min_distance = result.bodies[i].min_distance;
      min_distance = std::min(min_distance, std::abs(touch.gap));
      if (std::abs(touch.gap) >= kMaxGapAtTouch) continue;
      ++result.bodies[i].touches;
      is_elsewhere = false;
    }
    if (!is_elsewhere) continue;
    ++result.elsewhere;
    for (std::size_t i = 0; i < series.bodies.size(); ++i) {
      explain(series, contact, p_base_tip, poses, i, result.bodies[i]);
    }
  }
  return result;
}

std::optional<InputFault> placement_fault(const std::vector<InputBody>& bodies,
                                          const BodyPlacements& placement) {
  for (std::size_t i = 0; i < placement.bodies.size(); ++i) {
    if (auto fault = quaternion_fault(bodies[i].name, placement.bodies[i])) return fault;
  }
  if (auto fault = pose_unit_fault(bodies, placement)) return fault;
  return mesh_fault(bodies, placement);
}

namespace {

/// ", at the closest 0.131 m from box"; empty without bodies.
std::string nearest_text(const std::vector<InputBody>& bodies, const BodyPlacements& placement) {
  const auto nearest = std::min_element(placement.bodies.begin(), placement.bodies.end(),
                                        [](const BodyPlacement& a, const BodyPlacement& b) {
                                          return a.min_distance < b.min_distance;
                                        });
  if (nearest == placement.bodies.end()) return "";
  if (!std::isfinite(nearest->min_distance)) {
    return fmt::format(", but farther than {} m from each", kTouchSearchRadius);
  }
  const auto index = static_cast<std::size_t>(nearest - placement.bodies.begin());
  return fmt::format(", at the closest {:.3f} m from {}", nearest->min_distance,
                     bodies[index].name);
}

}  // namespace

std::vector<std::string> placement_notes(const std::vector<InputBody>& bodies,
                                         const BodyPlacements& placement) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < placement.bodies.size(); ++i) {
    const BodyPlacement& body = placement.bodies[i];
    if (!body.is_tracked || body.distance_at_start < kMaxDistanceAtStart) continue;
    notes.push_back(fmt::format(
        "{} is {:.3g} m from its pose in the scene when it is first tracked: the tracked poses are "
        "used; check the unit and the frame of both",
        bodies[i].name, body.distance_at_start));
  }
  if (placement.contacts > 0 && placement.elsewhere == placement.contacts) {
    notes.push_back(fmt::format(
        "when the force begins, the tip is at an object's surface in none of {} contact{}{}: "
        "poses, "
        "meshes and the tool's positions disagree, or an unknown object was touched",
        placement.contacts, placement.contacts == 1 ? "" : "s", nearest_text(bodies, placement)));
  }
  return notes;
}

std::vector<std::string> placement_contradictions(const std::vector<InputBody>& bodies,
                                                  const BodyPlacements& placement) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < placement.bodies.size(); ++i) {
    const BodyPlacement& body = placement.bodies[i];
    const std::size_t other = body.nearest_at_start;
    if (body.is_tracked && other > i && placement.bodies[other].is_tracked &&
        placement.bodies[other].nearest_at_start == i &&
        std::max(body.nearest_distance, placement.bodies[other].nearest_distance) < kAtStart &&
        std::min(body.distance_at_start, placement.bodies[other].distance_at_start) >
            kFarFromStart) {
      warnings.push_back(fmt::format(
          "the tracked poses of {} and {} begin in each other's place: {:.3f} m from its own pose "
          "in "
          "the scene, and {:.3f} m from the other's: their tracks are exchanged, or the objects "
          "are",
          bodies[i].name, bodies[other].name, body.distance_at_start, body.nearest_distance));
    }
    if (body.moved_untouched == 0.0) continue;
    const std::string gap = std::isfinite(body.gap_untouched)
                                ? fmt::format("{:.3f} m", body.gap_untouched)
                                : fmt::format("more than {} m", kTouchSearchRadius);
    warnings.push_back(fmt::format(
        "{} moves by {:.0f} mm in the contact at {}, in which the tip is {} from it: its tracked "
        "poses, its mesh or the tool's positions are off",
        bodies[i].name, 1e3 * body.moved_untouched, at_time(body.t_untouched), gap));
  }
  return warnings;
}

}  // namespace pcavr
