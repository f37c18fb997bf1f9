// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/turning/turning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/core/median.hpp"
#include "pcavr/friction/limit_surface.hpp"
#include "pcavr/identification/jackknife.hpp"
#include "pcavr/prediction/body_physics.hpp"

namespace pcavr {
namespace {

/// Displacement for one sample of the object's twist: many times the noise of its tracking.
constexpr double kMinTurnDisplacement = 0.004;  // [m], with rotations weighted by the lever below
constexpr double kRotationLever = 0.05;         // [m]
/// Minimum weighted rotation, as a share of the translation, of a twist that determines the radius.
constexpr double kMinRotationShare = 0.2;

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

/// When the object slid. A push as slow as the noise of the tip's speed shows no slides of its own,
/// but an object that was displaced while the force stayed near its level slid under it.
std::vector<SlideInterval> sliding_intervals(const ContactEpisode& episode) {
  if (!episode.slides.empty()) return without_gaps(episode.slides);
  std::vector<double> forces;
  const auto is_inside = [&](double t) { return t >= episode.begin && t <= episode.end; };
  for (std::size_t i = 0; i < episode.t.size(); ++i) {
    if (is_inside(episode.t[i])) forces.push_back(episode.force[i]);
  }
  if (forces.empty()) return {};
  const double level = kLoadedShare * median(std::move(forces));
  std::optional<SlideInterval> loaded;
  for (std::size_t i = 0; i < episode.t.size(); ++i) {
    const double t = episode.t[i];
    if (!is_inside(t) || episode.force[i] < level) continue;
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

/// In the axes of the planar pose midway between the two.
PushSample sample_between(const Planar& a, const Planar& b, const Eigen::Vector2d& force_base,
                          double moment) {
  const double turn = std::remainder(b.heading - a.heading, 2.0 * std::numbers::pi);
  const Eigen::Matrix2d R_body_base =
      Eigen::Rotation2Dd(-(a.heading + 0.5 * turn)).toRotationMatrix();
  PushSample sample;
  sample.wrench << R_body_base * force_base, moment;
  sample.twist << R_body_base * (b.p_base - a.p_base), turn;
  return sample;
}

/// Mean of force and moment about the object's centre of mass over [begin, end].
struct MeanLoad {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  double moment = 0.0;
  double count = 0.0;
};

class Turning {
 public:
  Turning(const BodyMotion& body, const PathView& tip, double tool_radius)
      : body_(body), tip_(tip), tool_radius_(tool_radius) {}

  void add(const AttributedContact& contact, std::vector<PushSample>& samples) const {
    const std::span<const TrackedPose> tracked = body_.tracked;
    for (const SlideInterval& slide : sliding_intervals(contact.episode)) {
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
        if (load.count >= 3.0) samples.push_back(sample_between(a, b, load.force, load.moment));
        from = &pose;
      }
    }
  }

 private:
  [[nodiscard]] MeanLoad mean_load(const AttributedContact& contact, const TrackedPose& from,
                                   const TrackedPose& to) const {
    const ContactEpisode& episode = contact.episode;
    MeanLoad load;
    for (std::size_t i = 0; i < episode.t.size(); ++i) {
      const double t = episode.t[i];
      if (t < from.t || t > to.t) continue;
      const Pose T_base_object =
          interpolate(from.T_base_object, to.T_base_object, (t - from.t) / (to.t - from.t));
      const Eigen::Vector3d normal = T_base_object.rotation() * contact.normal_object;
      const Eigen::Vector3d arm =
          tip_.at(t) - tool_radius_ * normal - T_base_object * body_.model.centre_of_mass_object;
      const Eigen::Vector3d& force = contact.force_base[i];
      load.force += force.head<2>();
      load.moment += arm.x() * force.y() - arm.y() * force.x();
      load.count += 1.0;
    }
    load.force /= std::max(load.count, 1.0);
    load.moment /= std::max(load.count, 1.0);
    return load;
  }

  BodyMotion body_;
  const PathView& tip_;
  double tool_radius_;
};

/// Friction radius of an ellipsoidal limit surface, r^2 = (m / f) (v / omega), as the median over
/// the samples with sufficient rotation.
std::optional<ParameterValue> ellipsoid_radius(const std::vector<PushSample>& samples) {
  std::vector<double> radii;
  for (const PushSample& sample : samples) {
    const double translation = sample.twist.head<2>().norm();
    if (kRotationLever * std::abs(sample.twist.z()) < kMinRotationShare * translation) continue;
    const double square =
        sample.wrench.z() / sample.wrench.head<2>().norm() * translation / sample.twist.z();
    if (square > 0.0) radii.push_back(std::sqrt(square));
  }
  if (radii.size() < 3) return std::nullopt;
  const double middle = median(radii);
  std::vector<double> residuals;
  residuals.reserve(radii.size());
  for (const double radius : radii) residuals.push_back(std::abs(radius - middle));
  // 1.4826: std from the median absolute residual; 1.2533: std of a median over that of a mean.
  const double std_of_radius = 1.4826 * median(residuals);
  return ParameterValue{middle,
                        1.2533 * std_of_radius / std::sqrt(static_cast<double>(radii.size()))};
}

/// Maximum friction moment over maximum friction force [m].
double radius_of(const LimitSurface& surface) {
  const double force = 0.5 * (sliding_load(surface, {1.0, 0.0, 0.0}).x() +
                              sliding_load(surface, {0.0, 1.0, 0.0}).y());
  return sliding_load(surface, {0.0, 0.0, 1.0}).z() / force;
}

/// Of the fitted limit surface. The ellipsoid's radius from nearly straight pushes is biased: a
/// quarter too small for a square patch.
std::optional<double> radius_of(const std::vector<PushSample>& samples,
                                const LimitSurfaceFitOptions& options) {
  const LimitSurfaceFit fit = fit_limit_surface(samples, options);
  if (fit.status == LimitSurfaceFitStatus::fitted) return radius_of(fit.surface);
  const std::optional<ParameterValue> radius = ellipsoid_radius(samples);
  return radius ? std::optional(radius->value) : std::nullopt;
}

std::vector<PushSample> samples_without(const SamplesOfPushes& pushes, std::size_t group) {
  std::vector<PushSample> samples;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (jackknife_group(i, pushes.size()) == group) continue;
    samples.insert(samples.end(), pushes[i].begin(), pushes[i].end());
  }
  return samples;
}

/// Std of the friction radius by leaving out pushes [m]: those of one push share its contact point.
/// Nothing where few pushes decide whether there is a radius.
std::optional<double> radius_std(const SamplesOfPushes& pushes,
                                 const LimitSurfaceFitOptions& options) {
  std::vector<double> radii;
  for (std::size_t group = 0; group < jackknife_groups(pushes.size()); ++group) {
    const std::optional<double> radius = radius_of(samples_without(pushes, group), options);
    if (radius) radii.push_back(*radius);
  }
  if (radii.size() < 2) return std::nullopt;
  return jackknife_std(radii);
}

}  // namespace

std::vector<PushSample> turning_samples(const AttributedContact& push, const BodyMotion& body,
                                        const PathView& tip, double tool_radius) {
  std::vector<PushSample> samples;
  Turning(body, tip, tool_radius).add(push, samples);
  return samples;
}

std::vector<PushSample> joined(const SamplesOfPushes& pushes) {
  std::vector<PushSample> samples;
  for (const std::vector<PushSample>& push : pushes) {
    samples.insert(samples.end(), push.begin(), push.end());
  }
  return samples;
}

LimitSurface surface_of_support(const CadModel& model, const Pose& T_base_object, double radius) {
  ObjectParameters known;
  known.friction_radius = ParameterValue{radius, {}};
  return *complete_physics(known, model, T_base_object).physics.limit_surface;
}

TurningFriction identify_turning(const SamplesOfPushes& pushes, const BodyMotion& body,
                                 const LimitSurfaceFitOptions& options) {
  const std::vector<PushSample> samples = joined(pushes);
  TurningFriction result{fit_limit_surface(samples, options), ellipsoid_radius(samples)};
  std::optional<ParameterValue>& radius = result.radius;
  if (!radius) return result;
  const bool is_fitted = result.surface.status == LimitSurfaceFitStatus::fitted;
  if (is_fitted) radius->value = radius_of(result.surface.surface);
  radius->std = std::max(*radius->std, radius_std(pushes, options).value_or(0.0));
  if (!is_fitted) return result;
  // Its shape: fifteen coefficients also follow the errors of the contact point and of few pushes,
  // which the support's shape does not have.
  const Pose& T_base_first = body.tracked.front().T_base_object;
  result.surface = fit_limit_surface(samples, options,
                                     surface_of_support(body.model, T_base_first, radius->value));
  return result;
}

}  // namespace pcavr
