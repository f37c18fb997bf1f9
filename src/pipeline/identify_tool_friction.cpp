// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/core/median.hpp"
#include "pcavr/inputs/touch.hpp"

#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// Path of the tip along the face for one sample of the friction: many times the noise of tracking,
/// and of the tangential deflection; and the longest time for it [s], beyond which the tip may have
/// stuck meanwhile.
constexpr double kMinSlip = 0.003;  // [m]
constexpr double kMaxSlipTime = 0.4;
/// On the path ahead and behind [m], the face must go on: elsewhere the tip touches another, too.
constexpr double kFreePath = 0.001;
constexpr double kSameNormal = 0.999;    // cosine: flat faces only
constexpr double kMinNormalForce = 2.0;  // [N] ten times the noise of an ordinary sensor
/// Of the normal force, across face and path: up to the one share by the path's uncertain
/// direction; beyond, it is the normal force of a second face, at right angles, that the tip slides
/// along, too; and up to the other, that face is not the main one.
constexpr double kMinAcross = 0.05, kMaxAcross = 0.5;
constexpr std::size_t kMinSamples = 4;

/// The tip's centre in the object's frame, at a tracked pose.
struct TipInObject {
  double t = 0.0;  ///< [s]
  Eigen::Vector3d p_object;
};

/// A tip that slides along a face.
class Rubbing {
 public:
  Rubbing(const BodyMotion& body, const PathView& tip, const BodySurface& surface, double radius)
      : body_(body), tip_(tip), surface_(surface), radius_(radius) {}

  void add(const IdentifiedContact& contact, std::vector<double>& coefficients) const {
    std::optional<TipInObject> from;
    for (const TrackedPose& pose : body_.tracked) {
      if (pose.t < contact.episode.begin || pose.t > contact.episode.end) continue;
      const TipInObject to{pose.t, pose.T_base_object.inverse() * tip_.at(pose.t)};
      if (!from || to.t - from->t > kMaxSlipTime) from = to;
      if ((to.p_object - from->p_object).norm() < kMinSlip) continue;
      if (const auto coefficient = between(contact, *from, to))
        coefficients.push_back(*coefficient);
      from = to;
    }
  }

 private:
  [[nodiscard]] std::optional<double> between(const IdentifiedContact& contact,
                                              const TipInObject& from,
                                              const TipInObject& to) const {
    const Eigen::Vector3d normal = normal_at(0.5 * (from.p_object + to.p_object));
    Eigen::Vector3d path = to.p_object - from.p_object;
    path -= normal.dot(path) * normal;
    if (path.norm() < kMinSlip) return std::nullopt;
    path.normalize();
    for (const Eigen::Vector3d& end : {Eigen::Vector3d(from.p_object - kFreePath * path),
                                       Eigen::Vector3d(to.p_object + kFreePath * path)}) {
      if (!(normal_at(end).dot(normal) > kSameNormal)) return std::nullopt;
    }
    const std::optional<Eigen::Vector3d> force = mean_force(contact, from.t, to.t);
    if (!force) return std::nullopt;
    const double pressed = -force->dot(normal);
    if (pressed < kMinNormalForce) return std::nullopt;
    double across = std::abs(force->dot(normal.cross(path)));
    if (across > kMaxAcross * pressed) return std::nullopt;
    if (across < kMinAcross * pressed) across = 0.0;
    return force->dot(path) / (pressed + across);
  }

  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& p_object) const {
    return surface_.touch(Pose(), p_object, radius_).normal_object;
  }

  /// In the object's frame.
  [[nodiscard]] std::optional<Eigen::Vector3d> mean_force(const IdentifiedContact& contact,
                                                          double begin, double end) const {
    const std::vector<double>& t = contact.episode.t;
    const auto first = std::lower_bound(t.begin(), t.end(), begin) - t.begin();
    const auto last = std::upper_bound(t.begin(), t.end(), end) - t.begin();
    if (last - first < 3) return std::nullopt;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      sum += pose_at(body_.tracked, t[i]).rotation().inverse() * contact.force_base[i];
    }
    return sum / static_cast<double>(last - first);
  }

  BodyMotion body_;
  const PathView& tip_;
  const BodySurface& surface_;
  double radius_;
};

/// [rad] of a face's normal, by that of the tracked rotation; it turns the force's components.
double normal_std(const BodyMotion& body) {
  std::vector<double> stds;
  stds.reserve(body.tracked.size());
  for (const TrackedPose& pose : body.tracked) stds.push_back(pose.rotation_std);
  return median(std::move(stds));
}

}  // namespace

void identify_tool_friction_of(const std::vector<IdentifiedContact>& contacts, std::size_t object,
                               const BodyMotion& body, const PathView& tip, double tool_radius,
                               ObjectIdentification& result) {
  const BodySurface surface(body.model);
  const Rubbing rubbing(body, tip, surface, tool_radius);
  std::vector<double> coefficients;
  int count = 0;
  for (const IdentifiedContact& contact : contacts) {
    if (contact.object != object || !contact.left_out.empty() || contact.episode.impact) continue;
    const std::size_t before = coefficients.size();
    rubbing.add(contact, coefficients);
    count += coefficients.size() > before ? 1 : 0;
  }
  if (coefficients.size() < kMinSamples) return;
  const double middle = median(coefficients);
  if (!(middle > 0.0)) return;
  std::vector<double> residuals;
  residuals.reserve(coefficients.size());
  for (const double value : coefficients) residuals.push_back(std::abs(value - middle));
  // The samples of one contact share their errors. 1.4826 and 1.2533: as in identify_turning.cpp.
  const double scatter =
      1.2533 * 1.4826 * median(residuals) / std::sqrt(static_cast<double>(count));
  result.parameters.tool_friction_coefficient =
      ParameterValue{middle, std::hypot(scatter, normal_std(body) * (1.0 + middle * middle))};
  result.tool_friction_contacts = count;
  result.parameters.sources.pushes["tool_friction_coefficient"] = count;
}

}  // namespace pcavr
