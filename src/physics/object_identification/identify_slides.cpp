// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/identify_slides.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/friction/standing.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/turning/support.hpp"

#include "physics/object_identification/tracked_motion.hpp"

namespace pcavr {
namespace {

constexpr double kSlideSmoothing = 0.040;  // [s] half width, well below a modulation's period
constexpr double kSlideSettle = 0.050;   // [s] after the breakaway's peak: the contact still swings
constexpr double kMinSlideSpeed = 5e-4;  // [m/s] below, it may be creep at rest, ...
constexpr double kSpeedNoise = 4.0;      // ... and below this many stds it may be noise
constexpr double kMinForceNoise = 4.0;   // stds of the smoothed force that mean contact
/// Tip and object move at nearly the same speed: the contact's compression changes by less than
/// this share of the tip's speed, so that an error of the contact law hardly matters.
constexpr double kMaxCompressionShare = 0.3;
constexpr double kMaxSpeedChange = 0.5;  // share, over one smoothing: a start or a stop
// Speed over that after it, below which friction has to settle anew: a stop shorter than the
// smoothing is not a zero of the speed. A modulation of 3 mm at 2 Hz on 60 mm/s remains above.
constexpr double kMinPastSpeed = 0.3;
constexpr double kDampingDifference = 0.5;  // of the half width: the step of a third derivative
constexpr double kMaxRotationShare = 0.6;   // beyond, friction is mostly that of turning
constexpr double kMaxStraightShare = 0.01;  // beyond, the object turns
constexpr double kFaceAgreement = 0.9;      // cosine between the force and the face that it pushes
constexpr double kMinPower = 0.3;           // of |F| |v|: less is no push through this face

/// Smallest tracked speed along the normal, as a share of the tip's: with less, the object rests
/// while the tip's holder gives way, or the tip leaves it. The speed by tracking has a noise of 2
/// to 4 %.
constexpr double kMinFollowing = 0.5;

// Limits for noise that the samples of a slow push show: their number, their travel [m], and the
// factor over the stated noise from which it is no chance.
constexpr std::size_t kMinShownSamples = 8;
constexpr double kMaxSlowTravel = 0.001;
constexpr double kMinShownNoise = 2.0;

/// One push's signals along its direction, smoothed.
struct SmoothSlide {
  double half_width = 0.0, interval = 0.0;
  double speed_std = 0.0, acceleration_std = 0.0, force_std = 0.0;
  double narrow_speed_std = 0.0;  ///< of `narrow`
  double compliance_std = 0.0;    ///< relative
  /// Stds of the compression's rate and acceleration, by the force's noise.
  double compression_speed_std = 0.0, compression_acceleration_std = 0.0;
  double noise_covariance = 0.0;  ///< [N m/s^2] of force and acceleration
  std::vector<SmoothedSample> object, tool, compression, force;
  std::vector<SmoothedSample> across;  ///< the tip's path to the left of the push
  std::vector<SmoothedSample> narrow;  ///< the object, over half the width
  /// The change of the object's motion by one std of the contact's damping.
  std::vector<double> damping_speed, damping_acceleration;
  std::array<std::vector<SmoothedSample>, 2> force_base;
};

/// [m/N] Compliance of the contact, typical of a push.
double compliance_of(const std::vector<double>& depth, const std::vector<double>& force,
                     double exponent) {
  std::vector<double> compliances;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] > 0.0 && depth[i] > 0.0) compliances.push_back(depth[i] / (exponent * force[i]));
  }
  return compliances.empty() ? 0.0 : median(std::move(compliances));
}

/// A damping c of F = k d^n (1 + c d') that was left out makes the depth too large by c d d' / n =
/// c (d^2)' / 2n, and the object's motion by its derivatives. Of `std` [s/m] of c.
void add_damping_change(const Contact& contact, const std::vector<double>& depth, double exponent,
                        double std, SmoothSlide& push) {
  const std::size_t count = depth.size();
  push.damping_speed.assign(count, 0.0);
  push.damping_acceleration.assign(count, 0.0);
  std::vector<double> squares;
  squares.reserve(count);
  for (const double one : depth) squares.push_back(one * one);
  const std::vector<SmoothedSample> smoothed =
      smooth(contact.t, squares, contact.t, push.half_width);
  const double factor = 0.5 * std / exponent;
  const auto steps = std::max<std::size_t>(
      1, static_cast<std::size_t>(kDampingDifference * push.half_width / push.interval));
  for (std::size_t i = 0; i < count; ++i) push.damping_speed[i] = factor * smoothed[i].acceleration;
  for (std::size_t i = steps; i + steps < count; ++i) {
    if (!smoothed[i - steps].is_valid || !smoothed[i + steps].is_valid) continue;
    push.damping_acceleration[i] = (push.damping_speed[i + steps] - push.damping_speed[i - steps]) /
                                   (contact.t[i + steps] - contact.t[i - steps]);
  }
}

SmoothSlide smooth_slide(const Contact& contact, const ContactCompliance& compliance,
                         double tool_interval) {
  const std::optional<HuntCrossley>& contact_law = compliance.law;
  SmoothSlide push;
  push.interval = mean_interval(contact.t);
  push.half_width = std::max({kSlideSmoothing, 3.0 * push.interval, 3.0 * tool_interval});
  const std::vector<double> force = remove_spikes(contact.force).values;
  std::vector<double> depth(force.size(), 0.0), object(force.size());
  if (contact_law) {
    depth = penetration_from_force(contact.t, force, *contact_law);
  } else if (contact.breakaway.stiffness > 0.0) {
    for (std::size_t i = 0; i < force.size(); ++i)
      depth[i] = force[i] / contact.breakaway.stiffness;
  }
  for (std::size_t i = 0; i < force.size(); ++i) object[i] = contact.tool[i] - depth[i];
  // Noise as of one tool sample: between two of them the positions are interpolated.
  const double spacing = std::max(push.interval, tool_interval);
  const double tip = contact.tip_noise.value_or(estimate_noise_std(contact.tool));
  const double exponent = contact_law ? contact_law->exponent : 1.0;
  // The contact's damping hides the compression's noise from differences of successive samples.
  const double force_noise = estimate_noise_std(force);
  const double soft = compliance_of(depth, force, exponent);
  const double noise = std::max(std::hypot(tip, soft * force_noise), estimate_noise_std(object));
  const double cube = std::pow(push.half_width, 3);
  const double square = push.half_width * push.half_width;
  push.speed_std = noise * std::sqrt(15.0 / 7.0 * spacing / cube);
  push.narrow_speed_std = push.speed_std * std::sqrt(8.0);  // the cube of half the width
  push.acceleration_std = noise * std::sqrt(22.5 * spacing / (cube * square));
  push.compliance_std = compliance.std;
  push.compression_speed_std = soft * force_noise * std::sqrt(15.0 / 7.0 * push.interval / cube);
  push.compression_acceleration_std =
      soft * force_noise * std::sqrt(22.5 * push.interval / (cube * square));
  push.force_std = force_noise / std::sqrt(correlated_samples(push.half_width, push.interval));
  push.noise_covariance = soft * force_noise * force_noise * 15.0 / 7.0 * push.interval / cube;
  const auto smoothed = [&](const std::vector<double>& values) {
    return smooth(contact.t, values, contact.t, push.half_width);
  };
  push.object = smoothed(object);
  push.narrow = smooth(contact.t, object, contact.t, 0.5 * push.half_width);
  push.tool = smoothed(contact.tool);
  push.compression = smoothed(depth);
  push.force = smoothed(force);
  add_damping_change(contact, depth, exponent, compliance.damping_std, push);
  for (int axis = 0; axis < 2; ++axis) {
    push.force_base[static_cast<std::size_t>(axis)] =
        smoothed(remove_spikes(axis_of(contact.force_base, axis)).values);
  }
  return push;
}

/// The end of loading [s]; without a breakaway, the first peak of the force above its median.
/// Loading while something gives way, or while tracking is smoothed over the onset, looks like a
/// slide.
double end_of_loading(const SmoothSlide& push, const Contact& contact) {
  std::vector<double> values;
  for (const SmoothedSample& force : push.force) {
    if (force.is_valid) values.push_back(force.value);
  }
  const double level = median(std::move(values));
  double end = contact.begin, peak = level;
  for (std::size_t i = 0; i < push.force.size(); ++i) {
    if (!push.force[i].is_valid) continue;
    if (push.force[i].value < level && peak > level) break;
    if (push.force[i].value <= peak) continue;
    peak = push.force[i].value;
    end = contact.t[i];
  }
  return end;
}

/// Raises the noise of a push's samples to what they show where that is clearly more: errors of the
/// tip and of tracking, over which slow motion is divided. Only where friction can't vary with the
/// place from sample to sample: as such it would be taken, and the push's level for its first one.
void raise_noise(std::span<FrictionSample> samples) {
  if (samples.size() < kMinShownSamples) return;
  std::vector<double> forces, travel, stated;
  for (const FrictionSample& sample : samples) {
    forces.push_back(sample.force);
    travel.push_back(sample.travel);
    stated.push_back(sample.force_std);
  }
  const double shown = estimate_noise_std(forces);
  if (median(std::move(travel)) > kMaxSlowTravel) return;
  if (shown < kMinShownNoise * median(std::move(stated))) return;
  for (FrictionSample& sample : samples) sample.force_std = std::max(sample.force_std, shown);
}

/// Share of the signal in the squares of what was measured, of a noise of this std.
double signal_share(double squares, std::size_t count, double noise_std) {
  const double noise = static_cast<double>(count) * noise_std * noise_std;
  return squares > noise ? 1.0 - noise / squares : 0.0;
}

/// Reduces the changes of the object's motion by another contact to the part that is expected
/// without the force's noise [regression calibration; Carroll et al. 2006, Measurement Error in
/// Nonlinear Models, ch. 4]. The same noise is in the object's acceleration, and an even speed fits
/// best where the contact gives way so little that it vanishes: steady pushes would say how stiff
/// it is.
void remove_noise(const SmoothSlide& push, std::span<FrictionSample> samples) {
  double speeds = 0.0, accelerations = 0.0;
  for (const FrictionSample& sample : samples) {
    speeds += std::pow(sample.speed_change, 2);
    accelerations += std::pow(sample.acceleration_change, 2);
  }
  const double speed_share =
      signal_share(speeds, samples.size(), push.compliance_std * push.compression_speed_std);
  const double acceleration_share = signal_share(
      accelerations, samples.size(), push.compliance_std * push.compression_acceleration_std);
  for (FrictionSample& sample : samples) {
    sample.speed_change *= speed_share;
    sample.acceleration_change *= acceleration_share;
    sample.damping_speed_change *= acceleration_share;
    sample.damping_acceleration_change *= acceleration_share;
  }
}

/// Interval of the tip's samples during a contact [s]; between contacts, its path may have gaps.
double tip_interval(std::span<const double> t, const Contact& contact) {
  const auto first = std::lower_bound(t.begin(), t.end(), contact.t.front());
  const auto last = std::upper_bound(first, t.end(), contact.t.back());
  return last - first > 1 ? mean_interval({first, last}) : mean_interval(t);
}

class Slides {
 public:
  Slides(const BodyMotion& body, const PathView& tip, double tool_radius, const KnownSupport& known)
      : body_(body), tip_(tip), tool_radius_(tool_radius), weight_(known.weight), motion_(body) {
    if (body.tracked.empty()) return;
    const Pose& T_base_first = body.tracked.front().T_base_object;
    height_ = support_height(body.model, T_base_first);
    gyration_radius_ = gyration_radius(body.model, T_base_first);
    support_.emplace(body.model, T_base_first);
    const double radius = support_->radius();
    if (!known.friction_radius || !(radius > 0.0)) return;
    scale_ = *known.friction_radius / radius;
    support_ = support_->scaled(scale_);
  }

  [[nodiscard]] std::vector<FrictionSample> of(const Contact& contact,
                                               const ContactCompliance& compliance) const {
    std::vector<FrictionSample> samples;
    if (contact.t.size() < 20 || contact.kind == ContactKind::press) return samples;
    SmoothSlide push = smooth_slide(contact, compliance, tip_interval(tip_.t(), contact));
    if (!body_.tracked.empty()) push.across = path_across(contact, push.half_width);
    const double loaded =
        contact.breakaway.is_found ? contact.breakaway.t : end_of_loading(push, contact);
    const double from = loaded + kSlideSettle + push.half_width;
    double next = from;
    for (std::size_t i = 0; i < contact.t.size(); ++i) {
      const double t = contact.t[i];
      if (t < next || t > contact.end - push.half_width) continue;
      if (!is_sliding(push, contact, i)) continue;
      std::optional<FrictionSample> sample = sample_at(contact, push, i);
      if (!sample) continue;
      // Within one sample of the force.
      sample->is_adjacent =
          !samples.empty() && t < samples.back().t + push.half_width + 1.5 * push.interval;
      next = t + push.half_width;
      samples.push_back(*sample);
    }
    remove_noise(push, samples);
    raise_noise(samples);
    return samples;
  }

 private:
  static Eigen::Vector2d left_of(const Contact& contact) {
    return {-contact.direction_base.y(), contact.direction_base.x()};
  }
  [[nodiscard]] std::vector<SmoothedSample> path_across(const Contact& contact,
                                                        double half_width) const {
    std::vector<double> path;
    for (const double t : contact.t) path.push_back(tip_.at(t).head<2>().dot(left_of(contact)));
    return smooth(contact.t, path, contact.t, half_width);
  }

  [[nodiscard]] bool is_sliding(const SmoothSlide& push, const Contact& contact,
                                std::size_t i) const {
    const SmoothedSample& object = push.object[i];
    if (!object.is_valid || !push.force[i].is_valid) return false;
    const double min_speed = std::max(kMinSlideSpeed, kSpeedNoise * push.speed_std);
    if (object.rate < min_speed || push.force[i].value < kMinForceNoise * push.force_std)
      return false;
    if (std::abs(push.compression[i].rate) > kMaxCompressionShare * std::abs(push.tool[i].rate))
      return false;
    // Neither a start nor a stop within the smoothing.
    const auto steps = static_cast<std::size_t>(push.half_width / push.interval);
    if (i < steps || i + steps >= push.object.size()) return false;
    for (const std::size_t k : {i - steps, i + steps}) {
      if (!push.object[k].is_valid || push.object[k].rate < kMaxSpeedChange * object.rate)
        return false;
      if (contact.t[k] < contact.begin || contact.t[k] > contact.end) return false;
    }
    return has_settled(push, contact, i);
  }

  /// Whether the object neither rested nor nearly did since friction's settling time, nor within
  /// the smoothing.
  static bool has_settled(const SmoothSlide& push, const Contact& contact, std::size_t i) {
    const double from = contact.t[i] - kSlideSettle - push.half_width;
    std::size_t k = i;
    for (; k > 0 && contact.t[k - 1] >= from; --k) {
      const SmoothedSample& before = push.object[k - 1];
      if (!before.is_valid || before.rate < kMinPastSpeed * push.object[i].rate) return false;
    }
    return !sticks_and_slips(push, contact, k, contact.t[i] + push.half_width);
  }

  /// Whether the speed from the sample `begin` until `to` swings so much that the object nearly
  /// stops, faster than the smoothing shows.
  static bool sticks_and_slips(const SmoothSlide& push, const Contact& contact, std::size_t begin,
                               double to) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t k = begin; k < push.narrow.size() && contact.t[k] <= to; ++k) {
      if (!push.narrow[k].is_valid) continue;
      count += 1.0, sum += push.narrow[k].rate, squares += std::pow(push.narrow[k].rate, 2);
    }
    if (count == 0.0) return false;
    const double mean = sum / count;
    const double variance = squares / count - mean * mean;
    const double noise = std::pow(push.narrow_speed_std, 2);
    const double amplitude = std::sqrt(2.0 * std::max(0.0, variance - noise));
    return variance > 2.0 * noise && amplitude > (1.0 - kMinPastSpeed) * mean;
  }

  /// The touched face's normal; at a corner, where the face does not give it, the force's
  /// direction.
  static Eigen::Vector2d inward_at(const Contact& contact, const Pose& T_base_object) {
    const Eigen::Vector2d along = contact.direction_base.head<2>().normalized();
    const Eigen::Vector2d inward =
        -(T_base_object.rotation() * contact.normal_object).head<2>().normalized();
    return inward.dot(along) > kFaceAgreement ? inward : along;
  }

  /// Of the points of the support, whose pressure is centred at `pressed`.
  struct SupportSpeeds {
    double mean = 0.0;     ///< [m/s]
    double squares = 0.0;  ///< [m^2/s^2] mean
  };
  [[nodiscard]] SupportSpeeds support_speeds(const Pose& T_base_object,
                                             const Eigen::Vector2d& pressed,
                                             const Eigen::Vector2d& centre, double rate) const {
    SupportSpeeds speeds;
    const Eigen::Rotation2Dd turned(heading_of(T_base_object));
    const std::vector<double> shares = support_->pressure(turned.inverse() * pressed);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const Eigen::Vector2d p = turned * support_->points()[k];
      const Eigen::Vector2d v = centre + rate * Eigen::Vector2d(-p.y(), p.x());
      speeds.mean += shares[k] * v.norm();
      speeds.squares += shares[k] * v.squaredNorm();
    }
    return speeds;
  }

  [[nodiscard]] std::optional<FrictionSample> sample_at(const Contact& contact,
                                                        const SmoothSlide& push,
                                                        std::size_t i) const {
    const double t = contact.t[i];
    const Eigen::Vector2d along = contact.direction_base.head<2>();
    const double speed = push.object[i].rate;
    FrictionSample sample{.t = t,
                          .force = push.force[i].value,
                          .speed = speed,
                          .acceleration = push.object[i].acceleration};
    sample.force_std = push.force_std;
    sample.speed_std = push.speed_std;
    sample.acceleration_std = push.acceleration_std;
    sample.noise_covariance = push.noise_covariance;
    sample.damping_speed_change = push.damping_speed[i];
    sample.damping_acceleration_change = push.damping_acceleration[i];
    sample.speed_change = push.compliance_std * push.compression[i].rate;
    sample.acceleration_change = push.compliance_std * push.compression[i].acceleration;
    sample.travel = speed * push.half_width;
    if (body_.tracked.empty()) return sample;
    const std::optional<Twist> twist = motion_.at(t, speed);
    // Off the centre of mass the force alone says little: the object turns under it.
    if (!twist) return is_centred(&contact) ? std::optional(sample) : std::nullopt;
    const Pose T_base_object = pose_at(body_.tracked, t);
    const Eigen::Vector2d force(push.force_base[0][i].value, push.force_base[1][i].value);
    const Eigen::Vector2d inward = inward_at(contact, T_base_object);
    const Eigen::Vector2d arm =
        (tip_.at(t) - T_base_object * body_.model.centre_of_mass_object).head<2>() +
        tool_radius_ * inward;
    const Eigen::Vector2d spin(-twist->rate * arm.y(), twist->rate * arm.x());
    const double normal_speed =
        speed * along.dot(inward) + push.across[i].rate * left_of(contact).dot(inward);
    const double tracked_speed = (twist->velocity + spin).dot(inward);
    if (tracked_speed < kMinFollowing * normal_speed) return std::nullopt;
    // Along the normal the tip is more accurate than the tracking, which is smoothed over more than
    // a modulation: the motion is as tracked, at the tip's pace.
    const double pace = normal_speed / tracked_speed;
    const Eigen::Vector2d at_contact = pace * (twist->velocity + spin);
    const Eigen::Vector2d centre = pace * twist->velocity;
    const double rate = pace * twist->rate;
    const Eigen::Vector2d pressed = centre_of_pressure(force, tip_.at(t).z() - height_, weight_);
    const auto [mean, squares] = support_speeds(T_base_object, pressed, centre, rate);
    if (mean <= 0.0) return std::nullopt;
    sample.rotation_share = 1.0 - std::min(1.0, centre.norm() / mean);
    const double power = force.dot(at_contact);
    if (sample.rotation_share > kMaxRotationShare) return std::nullopt;
    if (power < kMinPower * force.norm() * at_contact.norm()) return std::nullopt;
    const double gain = at_contact.norm() / mean;
    // The limit is for the CAD body's own support, which the square of the scale gives for small
    // shares: a small friction radius does not make the motion a straight one.
    sample.is_turning = sample.rotation_share > kMaxStraightShare * scale_ * scale_;
    sample.force = power / mean;
    sample.speed = squares / mean;
    // The whole motion grows with the tip's speed, whatever its direction, and so does the
    // rotation.
    const double inertia = centre.squaredNorm() + std::pow(gyration_radius_ * rate, 2);
    for (double* one :
         {&sample.acceleration, &sample.acceleration_change, &sample.damping_acceleration_change}) {
      *one *= inertia / (speed * mean);
    }
    sample.force_std *= gain;
    sample.travel = mean * push.half_width;
    return sample;
  }

  const BodyMotion& body_;
  const PathView& tip_;
  double tool_radius_;
  std::optional<double> weight_;  ///< [N]
  TrackedMotion motion_;
  double height_ = 0.0;           ///< [m] of the support, in base
  double gyration_radius_ = 0.0;  ///< [m] about the vertical through the centre of mass
  std::optional<Support> support_;
  double scale_ = 1.0;  ///< of the support against the CAD body's
};

}  // namespace

std::vector<FrictionSample> friction_samples(const std::vector<Contact*>& pushes,
                                             const ContactCompliance& compliance,
                                             const BodyMotion& body, const PathView& tip,
                                             double tool_radius, const KnownSupport& known) {
  std::vector<FrictionSample> samples;
  const Slides slides(body, tip, tool_radius, known);
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    for (FrictionSample& sample : slides.of(*pushes[i], compliance)) {
      samples.push_back(sample);
      samples.back().push = i;
    }
  }
  return samples;
}

}  // namespace pcavr
