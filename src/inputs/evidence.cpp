// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "inputs/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/gravity.hpp"
#include "pcavr/core/median.hpp"

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

/// From the first touch to the last sample that is still loaded.
struct LoadedRange {
  std::size_t begin = 0;
  std::size_t end = 0;  ///< one past the last
};

LoadedRange loaded_range(const AttributedContact& contact) {
  const ContactEpisode& episode = contact.episode;
  LoadedRange range;
  while (range.begin < episode.t.size() && episode.t[range.begin] < episode.begin) ++range.begin;
  for (std::size_t i = range.begin; i < contact.force_base.size(); ++i) {
    if (episode.t[i] > episode.end) break;
    if (contact.force_base[i].norm() >= kLoaded * episode.peak_force) range.end = i + 1;
  }
  return range;
}

Eigen::Matrix3d tool_axes_at(const InputSeries& series, double t) {
  const auto after = std::lower_bound(series.t_tool.begin(), series.t_tool.end(), t);
  const auto i = std::min(static_cast<std::size_t>(after - series.t_tool.begin()),
                          series.q_base_tool.size() - 1);
  return series.q_base_tool[i].toRotationMatrix();
}

void add_forces(const InputSeries& series, const AttributedContact& contact,
                const LoadedRange& range, const PathView& tip, ContactEvidence& evidence) {
  const std::vector<double>& t = contact.episode.t;
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
    const Eigen::Matrix3d R_base_tool = tool_axes_at(series, t[from]);
    evidence.tool_force_base += R_base_tool * sum;
    evidence.tool_work += (R_base_tool * force).dot(motion);
  }
}

/// Displacement of the object from the beginning of a contact until `t`.
double displacement_until(const AttributedContact& contact, const BodyPoses& poses, double t) {
  if (!poses.is_tracked(*contact.object)) return displacement_at(contact.episode, t);
  return translation_distance(poses.at(*contact.object, contact.episode.begin),
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
                                             std::span<const AttributedContact> contacts,
                                             const PathView& tip, const BodyPoses& poses) {
  std::vector<ContactEvidence> all;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const AttributedContact& contact = contacts[i];
    if (!contact.object || contact.force_base.empty()) continue;
    const LoadedRange range = loaded_range(contact);
    if (range.end < range.begin + 2) continue;
    ContactEvidence evidence{.contact = i};
    const double t = contact.episode.begin;
    evidence.inward_base =
        poses.touch(*contact.object, t, tip.at(t), series.tool_radius).inward_base;
    add_forces(series, contact, range, tip, evidence);
    all.push_back(evidence);
  }
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

std::optional<double> friction_ratio(const InputSeries& series, const AttributedContact& contact,
                                     const BodyPoses& poses) {
  if (!contact.object || contact.episode.kind == ContactKind::press) return std::nullopt;
  const double mass = mass_or_bound(series.bodies[*contact.object]);
  const ContactEpisode& episode = contact.episode;
  const double moved = displacement_until(contact, poses, episode.end);
  if (!(mass > 0.0) || moved < kMinDisplacement) return std::nullopt;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < contact.force_base.size(); ++i) {
    if (episode.t[i] < episode.begin || episode.t[i] > episode.end) continue;
    const double done = displacement_until(contact, poses, episode.t[i]) / moved;
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
