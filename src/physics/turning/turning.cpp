// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/turning/turning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/friction/standing.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/turning/support.hpp"

#include "physics/turning/friction_radius.hpp"

namespace pcavr {
namespace {

/// Displacement for one sample of the object's twist: many times the noise of its tracking.
constexpr double kMinTurnDisplacement = 0.004;  // [m], with rotations weighted by the lever below
constexpr double kRotationLever = 0.05;         // [m]

/// Share of a slow push's median force above which its object slides: the rest is the loading, and
/// the end.
constexpr double kLoadedShare = 0.7;

/// Slides this short after each other are one [s]: a body does not stop and start within it, but
/// the noise of a slow tip's speed seems to make it do so.
constexpr double kMaxSlideGap = 0.1;

/// The slides, those in rapid succession as one.
std::vector<SlideInterval> without_gaps(const std::vector<SlideInterval>& slides) {
  std::vector<SlideInterval> result;
  for (const SlideInterval& slide : slides) {
    if (!result.empty() && slide.begin - result.back().end <= kMaxSlideGap) {
      result.back().end = slide.end;
    } else {
      result.push_back(slide);
    }
  }
  return result;
}

/// The times in which the object slid. A push as slow as the noise of the tip's speed shows no
/// slides of its own, but an object that was displaced while the force stayed near its level slid
/// under it.
std::vector<SlideInterval> sliding_intervals(const Contact& contact) {
  if (!contact.slides.empty()) return without_gaps(contact.slides);
  std::vector<double> forces;
  const auto is_inside = [&](double t) { return t >= contact.begin && t <= contact.end; };
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    if (is_inside(contact.t[i])) forces.push_back(contact.force[i]);
  }
  if (forces.empty()) return {};
  const double level = kLoadedShare * median(std::move(forces));
  std::optional<SlideInterval> loaded;
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    const double t = contact.t[i];
    if (!is_inside(t) || contact.force[i] < level) continue;
    if (!loaded) loaded = SlideInterval{t, t};
    loaded->end = t;
  }
  return loaded ? std::vector{*loaded} : std::vector<SlideInterval>{};
}

/// Planar pose of the object's centre of mass.
struct Planar {
  Eigen::Vector2d p_base;
  double heading = 0.0;
};

Planar planar_of(const Pose& T_base_object, const CadModel& model) {
  return {(T_base_object * model.centre_of_mass_object).head<2>(), heading_of(T_base_object)};
}

/// Mean over [begin, end] of the load, its moment about the object's centre of mass.
struct MeanLoad {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  double moment = 0.0;
  Eigen::Vector2d centre_of_pressure = Eigen::Vector2d::Zero();
  double count = 0.0;
};

/// The sample between two poses, over a `duration` [s], in the axes of the planar pose midway,
/// about the centre of pressure.
PushSample sample_between(const Planar& a, const Planar& b, double duration, const MeanLoad& load) {
  const double turn = std::remainder(b.heading - a.heading, 2.0 * std::numbers::pi);
  const Eigen::Matrix2d R_body_base =
      Eigen::Rotation2Dd(-(a.heading + 0.5 * turn)).toRotationMatrix();
  const Eigen::Vector2d& centre = load.centre_of_pressure;
  const double moment = load.moment - centre.x() * load.force.y() + centre.y() * load.force.x();
  const Eigen::Vector2d moved =
      b.p_base - a.p_base + turn * Eigen::Vector2d(-centre.y(), centre.x());
  PushSample sample;
  sample.wrench << R_body_base * load.force, moment;
  sample.twist << R_body_base * moved, turn;
  sample.twist /= duration;
  sample.centre_of_pressure = R_body_base * centre;
  return sample;
}

class Turning {
 public:
  Turning(const BodyMotion& body, const PathView& tip, double tool_radius,
          const std::optional<double>& weight)
      : body_(body), tip_(tip), tool_radius_(tool_radius), weight_(weight) {
    if (body.tracked.empty()) return;
    support_height_ = support_height(body.model, body.tracked.front().T_base_object);
  }

  void add(const Contact& contact, std::vector<PushSample>& samples) const {
    const std::span<const TrackedPose> tracked = body_.tracked;
    for (const SlideInterval& slide : sliding_intervals(contact)) {
      const TrackedPose* from = nullptr;
      for (const TrackedPose& pose : tracked) {
        if (pose.t < slide.begin || pose.t > slide.end) continue;
        if (from == nullptr) from = &pose;
        const Planar a = planar_of(from->T_base_object, body_.model);
        const Planar b = planar_of(pose.T_base_object, body_.model);
        const double turn = std::remainder(b.heading - a.heading, 2.0 * std::numbers::pi);
        if (std::hypot((b.p_base - a.p_base).norm(), kRotationLever * turn) < kMinTurnDisplacement)
          continue;
        const MeanLoad load = mean_load(contact, *from, pose);
        if (load.count >= 3.0) samples.push_back(sample_between(a, b, pose.t - from->t, load));
        from = &pose;
      }
    }
  }

 private:
  [[nodiscard]] MeanLoad mean_load(const Contact& contact, const TrackedPose& from,
                                   const TrackedPose& to) const {
    MeanLoad load;
    for (std::size_t i = 0; i < contact.t.size(); ++i) {
      const double t = contact.t[i];
      if (t < from.t || t > to.t) continue;
      const Pose T_base_object =
          interpolate(from.T_base_object, to.T_base_object, (t - from.t) / (to.t - from.t));
      const Eigen::Vector3d normal = T_base_object.rotation() * contact.normal_object;
      const Eigen::Vector3d arm =
          tip_.at(t) - tool_radius_ * normal - T_base_object * body_.model.centre_of_mass_object;
      const Eigen::Vector3d& force = contact.force_base[i];
      load.force += force.head<2>();
      load.moment += arm.x() * force.y() - arm.y() * force.x();
      const double height = tip_.at(t).z() - tool_radius_ * normal.z() - support_height_;
      load.centre_of_pressure += centre_of_pressure(force.head<2>(), height, weight_);
      load.count += 1.0;
    }
    const double count = std::max(load.count, 1.0);
    load.force /= count;
    load.moment /= count;
    load.centre_of_pressure /= count;
    return load;
  }

  BodyMotion body_;
  const PathView& tip_;
  double tool_radius_;
  std::optional<double> weight_;  ///< [N]
  double support_height_ = 0.0;   ///< [m] in base
};

}  // namespace

std::vector<PushSample> turning_samples(const Contact& push, const BodyMotion& body,
                                        const PathView& tip, double tool_radius,
                                        const std::optional<double>& weight) {
  std::vector<PushSample> samples;
  Turning(body, tip, tool_radius, weight).add(push, samples);
  return samples;
}

std::vector<PushSample> joined(const SamplesOfPushes& pushes) {
  std::vector<PushSample> samples;
  for (std::size_t push = 0; push < pushes.size(); ++push) {
    for (const PushSample& sample : pushes[push]) {
      samples.push_back(sample);
      samples.back().push = push;
    }
  }
  return samples;
}

LimitSurface surface_of_support(const CadModel& model, const Pose& T_base_object, double radius) {
  ObjectParameters known;
  known.friction_radius = ParameterValue{radius, {}};
  return *complete_physics(known, model, T_base_object).physics.limit_surface;
}

namespace {

/// Whether pushes have shown a radius: before, the support's pressure may be anywhere from its
/// centre to its rim, so that the radius is uniform between 0 and that of the farthest point.
bool is_narrower_than_prior(const ParameterValue& radius, const Support& support) {
  double rim = 0.0;
  for (const Eigen::Vector2d& point : support.points()) rim = std::max(rim, point.norm());
  return kIdentifiedFactor * *radius.std < rim / std::sqrt(12.0);
}

}  // namespace

std::vector<PushSample> of_even_pressure(std::vector<PushSample> samples, const Support& support) {
  for (PushSample& sample : samples) {
    const double share = moved_radius_share(support, sample.centre_of_pressure);
    sample.wrench.z() /= share;
    sample.twist.z() *= share;
  }
  return samples;
}

std::vector<PushSample> without_viscous_load(std::vector<PushSample> samples,
                                             const Support& support, double viscous) {
  for (PushSample& sample : samples) sample.wrench -= viscous_load(support, sample, viscous);
  return samples;
}

TurningFriction identify_turning(const SamplesOfPushes& pushes, const BodyMotion& body,
                                 const ParameterValue& viscous,
                                 const LimitSurfaceFitOptions& options) {
  const std::vector<PushSample> samples = joined(pushes);
  TurningFriction result{fit_limit_surface(samples, options)};
  if (samples.empty()) return result;
  const Pose& T_base_first = body.tracked.front().T_base_object;
  const Support support(body.model, T_base_first);
  if (!(support.radius() > 0.0)) return result;
  const LimitSurface shape = surface_of_support(body.model, T_base_first, support.radius());
  result.radius = friction_radius_of(pushes, support, shape, viscous, options);
  if (result.radius && !is_narrower_than_prior(*result.radius, support)) return {};
  if (!result.radius || result.surface.status != LimitSurfaceFitStatus::fitted) return result;
  // Its shape: fifteen coefficients also follow the errors of the contact point and of few pushes,
  // which the support's shape does not have.
  const Support found = support.scaled(result.radius->value / support.radius());
  result.surface = fit_limit_surface(
      of_even_pressure(without_viscous_load(samples, found, viscous.value), found), options,
      surface_of_support(body.model, T_base_first, result.radius->value));
  return result;
}

}  // namespace pcavr
