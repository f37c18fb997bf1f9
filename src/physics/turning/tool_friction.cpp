// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/turning/tool_friction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcavr/base/core/doubted.hpp"
#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// Slip along the face for one sample of the friction: many times the noise of tracking, and of the
/// tangential deflection.
constexpr double kMinSlip = 0.003;  // [m]
/// Share of the tip's path in base that must be slip: a tip that sticks is carried along, and seems
/// to slip by the share that an error of its radius is of the lever that it turns the object by.
constexpr double kMinSlipShare = 0.25;
constexpr double kMaxPath = kMinSlip / kMinSlipShare;  // [m] for one sample
/// Length of the path ahead and behind [m] over which the face must go on: elsewhere the tip
/// touches another face, too.
constexpr double kFreePath = 0.001;
constexpr double kSameNormal = 0.999;    // cosine: flat faces only
constexpr double kMinNormalForce = 1.0;  // [N] ten times the offset of an ordinary sensor
/// Shares of the normal force for the force across face and path. Below the first it comes from the
/// path's uncertain direction. Beyond, it is the normal force of a second face, at right angles,
/// that the tip slides along, too; below the second, that face is not the main one.
constexpr double kMinAcross = 0.05, kMaxAcross = 0.5;
constexpr std::size_t kMinSamples = 4;
/// Share of the samples in which the force opposes the slip: fewer are no friction.
constexpr double kMinOpposing = 0.75;
/// Share by which friction differs from contact to contact at least: repeated ones differ by 2 to
/// 5 %.
constexpr double kFrictionScatter = 0.02;
constexpr double kMinRise = 5e-5;  // [m] std by which a path leaves its face: that of good tracking

/// The tip's centre at a tracked pose.
struct TipAtPose {
  double t = 0.0;  ///< [s]
  Eigen::Vector3d p_base, p_object;
  Eigen::Quaterniond R_base_object;
};

/// A tip that slides along a face. The tool itself is not expected to turn.
class Rubbing {
 public:
  Rubbing(const BodyMotion& body, const PathView& tip, const BodySurface& surface, double radius)
      : body_(body), tip_(tip), surface_(surface), radius_(radius) {}

  void add(const Contact& contact, std::vector<RubbedPart>& parts) const {
    const std::vector<TipAtPose> tips = tips_during(contact);
    std::size_t from = 0;
    for (std::size_t to = 0; to < tips.size(); ++to) {
      while ((tips[to].p_base - tips[from].p_base).norm() > kMaxPath) ++from;
      if (!has_slipped(tips[from], tips[to])) continue;
      if (const auto part = during(contact, std::span(tips).subspan(from, to - from + 1)))
        parts.push_back(*part);
      from = to;
    }
  }

 private:
  [[nodiscard]] std::vector<TipAtPose> tips_during(const Contact& contact) const {
    std::vector<TipAtPose> tips;
    for (const TrackedPose& pose : body_.tracked) {
      if (pose.t < contact.begin || pose.t > contact.end) continue;
      const Eigen::Vector3d p_base = tip_.at(pose.t);
      tips.push_back(
          {pose.t, p_base, pose.T_base_object.inverse() * p_base, pose.T_base_object.rotation()});
    }
    return tips;
  }

  /// Slip of the tip's material along the face, in the object's frame [m], less the way that the
  /// tip rolls.
  [[nodiscard]] Eigen::Vector3d slip_between(const TipAtPose& from, const TipAtPose& to,
                                             const Eigen::Vector3d& normal) const {
    const Eigen::AngleAxisd turn(from.R_base_object.inverse() * to.R_base_object);
    const Eigen::Vector3d slip =
        to.p_object - from.p_object + radius_ * turn.angle() * turn.axis().cross(normal);
    return slip - normal.dot(slip) * normal;
  }

  [[nodiscard]] bool has_slipped(const TipAtPose& from, const TipAtPose& to) const {
    const double rolled = radius_ * from.R_base_object.angularDistance(to.R_base_object);
    if ((to.p_object - from.p_object).norm() + rolled < kMinSlip) return false;
    return slip_between(from, to, normal_between(from, to)).norm() >= kMinSlip;
  }

  /// The work of the force's parts over the slip: so a pause has no weight.
  [[nodiscard]] std::optional<RubbedPart> during(const Contact& contact,
                                                 std::span<const TipAtPose> tips) const {
    const TipAtPose &from = tips.front(), &to = tips.back();
    const Eigen::Vector3d normal = normal_between(from, to);
    const Eigen::Vector3d path = slip_between(from, to, normal).normalized();
    for (const Eigen::Vector3d& end : {Eigen::Vector3d(from.p_object - kFreePath * path),
                                       Eigen::Vector3d(to.p_object + kFreePath * path)}) {
      if (!(normal_at(end).dot(normal) > kSameNormal)) return std::nullopt;
    }
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double slip = 0.0;
    for (std::size_t i = 1; i < tips.size(); ++i) {
      const double step = slip_between(tips[i - 1], tips[i], normal).dot(path);
      force += step * mean_force(contact, tips[i - 1].t, tips[i].t);
      slip += step;
    }
    force /= slip;
    const double pressed = -force.dot(normal);
    double across = std::abs(force.dot(normal.cross(path)));
    if (pressed < kMinNormalForce) return std::nullopt;
    if (across > kMaxAcross * pressed) return std::nullopt;
    if (across < kMinAcross * pressed) across = 0.0;
    const Eigen::Vector3d up = from.R_base_object.inverse() * Eigen::Vector3d::UnitZ();
    return RubbedPart{.coefficient = force.dot(path) / (pressed + across),
                      .slip_about_z = slip * path.dot(up.cross(normal)),
                      .rise = gap_at(to.p_object) - gap_at(from.p_object)};
  }

  [[nodiscard]] Eigen::Vector3d normal_between(const TipAtPose& from, const TipAtPose& to) const {
    return normal_at(0.5 * (from.p_object + to.p_object));
  }
  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& p_object) const {
    return surface_.touch(Pose(), p_object, radius_).normal_object;
  }
  [[nodiscard]] double gap_at(const Eigen::Vector3d& p_object) const {
    return surface_.touch(Pose(), p_object, radius_).gap;
  }

  /// The mean force in the object's frame; that of the next sample where none lies between.
  [[nodiscard]] Eigen::Vector3d mean_force(const Contact& contact, double begin, double end) const {
    const std::vector<double>& t = contact.t;
    const auto first = std::min<std::ptrdiff_t>(
        std::lower_bound(t.begin(), t.end(), begin) - t.begin(), std::ssize(t) - 1);
    const auto last = std::max(std::upper_bound(t.begin(), t.end(), end) - t.begin(), first + 1);
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

/// Std of a face's normal [rad], by that of the tracked rotation; it turns the force's components.
double normal_std(std::span<const TrackedPose> tracked) {
  std::vector<double> stds;
  stds.reserve(tracked.size());
  for (const TrackedPose& pose : tracked) stds.push_back(pose.rotation_std);
  return median(std::move(stds));
}

/// The turn about z [rad] that makes the tip's path one along the faces, by least squares.
FaceTurn face_turn(std::span<const std::vector<RubbedPart>> contacts) {
  double information = 0.0, sum = 0.0, squares = 0.0, count = 0.0;
  for (const std::vector<RubbedPart>& contact : contacts) {
    for (const RubbedPart& part : contact) {
      information += part.slip_about_z * part.slip_about_z;
      sum += part.slip_about_z * part.rise;
      squares += part.rise * part.rise;
      count += 1.0;
    }
  }
  if (!(information > 0.0) || count < 2.0) return {};
  const double turn = sum / information;
  const double variance = std::max(0.0, squares - turn * sum) / (count - 1.0);
  return {turn, std::sqrt(std::max(variance, kMinRise * kMinRise) / information)};
}

}  // namespace

double FaceTurn::doubt() const { return std > 0.0 ? doubted(turn, std) : 0.0; }

std::vector<RubbedPart> rubbed_parts(const Contact& contact, const BodyMotion& body,
                                     const BodySurface& surface, const PathView& tip,
                                     double tool_radius) {
  std::vector<RubbedPart> parts;
  Rubbing(body, tip, surface, tool_radius).add(contact, parts);
  return parts;
}

std::optional<ToolFriction> tool_friction_of(std::span<const std::vector<RubbedPart>> contacts,
                                             std::span<const TrackedPose> tracked) {
  std::vector<double> coefficients;
  int count = 0;
  for (const std::vector<RubbedPart>& contact : contacts) {
    for (const RubbedPart& part : contact) coefficients.push_back(part.coefficient);
    count += contact.empty() ? 0 : 1;
  }
  if (coefficients.size() < kMinSamples) return std::nullopt;
  const auto opposing = std::count_if(coefficients.begin(), coefficients.end(),
                                      [](double coefficient) { return coefficient > 0.0; });
  if (static_cast<double>(opposing) < kMinOpposing * static_cast<double>(coefficients.size()))
    return std::nullopt;
  const double middle = median(coefficients);
  std::vector<double> residuals;
  residuals.reserve(coefficients.size());
  for (const double value : coefficients) residuals.push_back(std::abs(value - middle));
  constexpr double kStdOfMedianOverMean = 1.2533;  // of normal samples
  // The samples of one contact share their errors.
  const double scatter = kStdOfMedianOverMean * kStdOverMad * median(residuals) /
                         std::sqrt(static_cast<double>(count));
  // The few contacts that there usually are agree by chance.
  const double least = kFrictionScatter * middle / std::sqrt(static_cast<double>(count));
  const FaceTurn turn = face_turn(contacts);
  const double direction = std::hypot(normal_std(tracked), turn.doubt()) * (1.0 + middle * middle);
  return ToolFriction{{middle, std::hypot(std::max(scatter, least), direction)}, count, turn};
}

}  // namespace pcavr
