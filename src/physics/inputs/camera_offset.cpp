// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

// [m]: with a larger lever arm, a push rotates the object, and the tip may slide along it.
constexpr double kMaxLever = 0.010;
constexpr double kSameNormal = 0.98;  // cosine
/// Smallest speed of a slide [m/s]: in a slower one, a tenth of a millimetre of the contact's
/// compression is 20 ms.
constexpr double kMinSlideSpeed = 0.005;
constexpr double kRestBefore = 0.2;  // [s] included: a slide at constant speed alone fits any delay
constexpr double kSpeedStep = 0.02;  // [s] of the central difference for the speed
constexpr double kMaxOffset = 0.25;  // [s] as for the force
constexpr double kMaxOffsetStep = 0.05;
constexpr int kIterations = 8;
constexpr double kMinPoses = 8.0;
constexpr double kMinStds = 3.0;  // of an offset that the distances are asked about

constexpr double kMinPushDisplacement = 0.005;  // [m] of displacement that is certainly a push
// Free time kept around a motion, and the offset's range [s].
constexpr double kAroundMotion = 1.0;
constexpr double kMotionRange = 0.2;
// [s] by a path that turns with the object, and by the contact's compression.
constexpr double kMotionBias = 0.005;
constexpr double kMinMotionSpeed = 0.1;  // [m/s] between frames: certainly in motion

/// The pushed face of a tracked object against the tip, along the face's normal: there the object
/// moves with the tip, though it turns and the tip slides along it.
class PushedFace {
 public:
  PushedFace(const Contact& contact, const PathView& tip, std::span<const TrackedPose> tracked)
      : contact_(contact), tip_(tip) {
    const Eigen::Vector3d& along = contact_.direction_base;
    const Pose T_base_begin = pose_at(tracked, contact_.begin);
    p_object_ = T_base_begin.inverse() * tip.at(contact_.slides.front().begin);
    // A corner's normal is that of the force.
    const Eigen::Vector3d inward = -(T_base_begin.rotation() * contact.normal_object);
    inward_object_ =
        T_base_begin.rotation().inverse() * (inward.dot(along) > kSameNormal ? inward : along);
  }

  /// [m] From the tip, less the contact's compression; `at` by the tool's clock.
  [[nodiscard]] double gap(const Pose& T_base_object, double at) const {
    return normal(T_base_object).dot(T_base_object * p_object_ - pushed_to(at));
  }
  /// Speed of the tip along the face's normal [m/s].
  [[nodiscard]] double speed(const Pose& T_base_object, double at) const {
    const Eigen::Vector3d step = pushed_to(at + kSpeedStep) - pushed_to(at - kSpeedStep);
    return normal(T_base_object).dot(step) / (2.0 * kSpeedStep);
  }

 private:
  [[nodiscard]] Eigen::Vector3d normal(const Pose& T_base_object) const {
    return T_base_object.rotation() * inward_object_;
  }
  /// The place to which the tip has pushed: it begins where the first slide does, and rests between
  /// slides.
  [[nodiscard]] Eigen::Vector3d pushed_to(double at) const {
    const Eigen::Vector3d& along = contact_.direction_base;
    Eigen::Vector3d p = tip_.at(contact_.slides.front().begin);
    for (const SlideInterval& slide : contact_.slides) {
      const Eigen::Vector3d path =
          tip_.at(std::clamp(at, slide.begin, slide.end)) - tip_.at(slide.begin);
      p += path - path.dot(along) * along;
    }
    return p + displacement_at(contact_, at) * along;
  }

  const Contact& contact_;
  const PathView& tip_;
  Eigen::Vector3d p_object_, inward_object_;
};

bool slides_at(const Contact& contact, double t) {
  return std::any_of(contact.slides.begin(), contact.slides.end(), [t](const SlideInterval& slide) {
    return t >= slide.begin && t <= slide.end;
  });
}

double slide_speed(const Contact& contact) {
  double duration = 0.0;
  for (const SlideInterval& slide : contact.slides) duration += slide.end - slide.begin;
  return displacement_at(contact, contact.slides.back().end) / std::max(duration, 1e-6);
}

double lagged_product(const std::vector<double>& values, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) sum += values[i - lag] * values[i];
  return sum;
}

/// Variance of a regression of values with these residuals over that with independent ones of
/// their mean square: 1 + 2 sum r(k) s(k), with the autocorrelations r of the residuals and s of
/// the regressor [Bartlett 1935], as far as r is positive [initial sequence: Geyer 1992]. Their
/// mean and the regression have taken off residuals of 1 + 2 sum r(k) and of this many samples.
double variance_inflation(const std::vector<double>& residuals,
                          const std::vector<double>& regressor) {
  const double of_residuals = lagged_product(residuals, 0);
  const double of_regressor = lagged_product(regressor, 0);
  if (!(of_residuals > 0.0) || !(of_regressor > 0.0)) return 1.0;
  double of_mean = 1.0, of_slope = 1.0;
  for (std::size_t lag = 1; lag < residuals.size(); ++lag) {
    const double correlation = lagged_product(residuals, lag) / of_residuals;
    if (!(correlation > 0.0)) break;
    of_mean += 2.0 * correlation;
    of_slope += 2.0 * correlation * lagged_product(regressor, lag) / of_regressor;
  }
  of_slope = std::max(of_slope, 1.0);
  const auto count = static_cast<double>(residuals.size());
  return of_slope * count / std::max(count - of_mean - of_slope, 1.0);
}

/// Sums of a linear least-squares fit of the gap on the speed, about each contact's means: one
/// Gauss-Newton step of the offset.
struct Sums {
  double speed_squares = 0.0;     ///< [m^2/s^2]
  double correlated = 0.0;        ///< [m^2/s^2] the same, each contact's times its inflation
  double gradient = 0.0;          ///< [m^2/s]
  double bias = 0.0;              ///< [m^2/s] std of the gradient by errors that last for a slide
  double residual_squares = 0.0;  ///< [m^2]
  double count = 0.0;

  void add(const Contact& contact, const PathView& tip, std::span<const TrackedPose> tracked,
           double offset) {
    const PushedFace face(contact, tip, tracked);
    std::vector<double> residual, speed;
    for (const TrackedPose& pose : tracked) {
      if (pose.t < contact.begin - kRestBefore || pose.t > contact.end) continue;
      residual.push_back(face.gap(pose.T_base_object, pose.t - offset));
      speed.push_back(face.speed(pose.T_base_object, pose.t - offset));
    }
    if (residual.size() < 4) return;
    const auto n = static_cast<double>(residual.size());
    double mean = 0.0, mean_speed = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
      mean += residual[i] / n;
      mean_speed += speed[i] / n;
    }
    for (std::size_t i = 0; i < residual.size(); ++i) {
      residual[i] -= mean;
      speed[i] -= mean_speed;
      gradient -= speed[i] * residual[i];
    }
    const double squares = lagged_product(speed, 0);
    speed_squares += squares;
    correlated += variance_inflation(residual, speed) * squares;
    // Residuals that last from frame to frame may last for the slide, as a compression of the
    // contact that differs from its law's: at one speed, that looks like a delay.
    const double lasting = std::sqrt(std::max(0.0, lagged_product(residual, 1)) / n);
    bias += lasting * squares / slide_speed(contact);
    residual_squares += lagged_product(residual, 0);
    count += n;
  }
};

/// [s] Std of a slide's ends where samples are so few that the smoothing, which needs three
/// intervals, is wider than `half_width`: they lie anywhere in that excess.
double slide_end_std(const Contact& push, double half_width) {
  return std::max(0.0, 3.0 * mean_interval(push.t) - half_width) / std::sqrt(3.0);
}

/// Whether force, tool and tracking were recorded before the contact: of a push that was under way
/// when the recording began nobody knows when the object was at rest.
bool begins_in(const InputSeries& series, const Contact& contact) {
  const double rest = contact.begin - kRestBefore;
  const std::vector<double> starts{series.t_tool.empty() ? rest : series.t_tool.front(),
                                   series.t_force.empty() ? rest : series.t_force.front(),
                                   series.bodies[*contact.object].tracked.front().t};
  return std::ranges::all_of(starts, [rest](double start) { return start <= rest; });
}

/// Whether the object moves with the tip: pushed through its centre, or on a flat face.
bool is_usable(const Contact& contact, const PathView& tip, const InputSeries& series,
               const std::vector<BodySurface>& surfaces) {
  if (!contact.object || !contact.left_out.empty() || contact.slides.empty()) return false;
  if (slide_speed(contact) < kMinSlideSpeed) return false;
  if (std::abs(contact.lever) <= kMaxLever) return true;
  const double end = contact.slides.back().end;
  const Pose T_base_end = pose_at(series.bodies[*contact.object].tracked, end);
  const Touch touch = surfaces[*contact.object].touch(T_base_end, tip.at(end), series.tool_radius);
  return touch.normal_object.dot(contact.normal_object) > kSameNormal;
}

/// Median distance [m] of the tip from its places on the pushed faces at the begin of the first
/// slide, during slides, with tracking delayed by `offset` [s].
double distance_from_faces(const InputSeries& series, const std::vector<BodySurface>& surfaces,
                           const PathView& tip, std::span<const Contact* const> pushes,
                           double offset) {
  std::vector<double> distances;
  for (const Contact* push : pushes) {
    const std::span<const TrackedPose> tracked = series.bodies[*push->object].tracked;
    const auto gap = [&](double t_pose, double t) {
      return surfaces[*push->object]
          .touch(pose_at(tracked, t_pose), tip.at(t), series.tool_radius)
          .gap;
    };
    // Before it slides the object rests, so that a delay does not matter.
    const double pressed = gap(push->begin, push->slides.front().begin);
    for (const double t : push->t) {
      if (slides_at(*push, t)) distances.push_back(std::abs(gap(t + offset, t) - pressed));
    }
  }
  return distances.empty() ? 0.0 : median(std::move(distances));
}

/// Squares [m^2] of the gaps that remain if the tracked pose is not late but off, by one length as
/// long as a push slides; the number of frames, and of such lengths.
struct ShiftFit {
  double residual_squares = 0.0, count = 0.0, shifts = 0.0;

  void add(const Contact& contact, const PathView& tip, std::span<const TrackedPose> tracked) {
    const PushedFace face(contact, tip, tracked);
    std::array<std::vector<double>, 2> gaps;  // at rest, sliding
    std::vector<double> at_ends;
    for (std::size_t i = 1; i < tracked.size(); ++i) {
      const double t = tracked[i].t, frame = t - tracked[i - 1].t;
      if (t < contact.begin - kRestBefore || t > contact.end) continue;
      const double gap = face.gap(tracked[i].T_base_object, t);
      const bool slides = slides_at(contact, t);
      const bool is_at_end =
          slides != slides_at(contact, t - frame) || slides != slides_at(contact, t + frame);
      (is_at_end ? at_ends : gaps[slides ? 1 : 0]).push_back(gap);
    }
    if (gaps[0].size() + gaps[1].size() < 4) return;
    shifts += 1.0;
    count += static_cast<double>(gaps[0].size() + gaps[1].size() + at_ends.size());
    const std::array<double, 2> means{mean_of(gaps[0]), mean_of(gaps[1])};
    const auto square = [](double value, double mean) { return (value - mean) * (value - mean); };
    for (std::size_t k = 0; k < 2; ++k) {
      for (const double gap : gaps[k]) residual_squares += square(gap, means[k]);
    }
    // A slide's ends are not known to a frame.
    for (const double gap : at_ends) {
      residual_squares += std::min(square(gap, means[0]), square(gap, means[1]));
    }
  }

 private:
  static double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
  }
};

/// Whether the poses are rather shifted than late. At constant speed, a pose that is off as long as
/// the object slides looks late, except where the slide begins and ends. The better fit is the one
/// that needs fewer numbers for smaller residuals [Schwarz 1978, Bayesian information criterion].
bool is_rather_shifted(const Sums& late, const ShiftFit& shifted) {
  if (!(late.residual_squares > 0.0) || shifted.count <= 0.0) return false;
  const double ratio = std::max(shifted.residual_squares, 0.0) / late.residual_squares;
  return shifted.count * std::log(std::max(ratio, 1e-12)) +
             (shifted.shifts - 1.0) * std::log(shifted.count) <
         0.0;
}

/// The same as distance_from_faces for a body that something moves without a force: from its
/// surface.
double distance_from_body(const InputBody& body, const BodySurface& surface, const PathView& tip,
                          double tool_radius, std::span<const TrackedPose> moving, double offset) {
  std::vector<double> distances;
  for (const TrackedPose& pose : moving) {
    const double t = pose.t - offset;
    distances.push_back(
        std::abs(surface.touch(pose_at(body.tracked, pose.t), tip.at(t), tool_radius).gap));
  }
  return distances.empty() ? 0.0 : median(std::move(distances));
}

/// The frames of an object's longest uninterrupted motion.
struct Motion {
  std::size_t begin = 0;
  std::size_t end = 0;
  double length = 0.0;  ///< [m] of the path
};
Motion longest_motion(std::span<const TrackedPose> tracked) {
  Motion longest;
  Motion now;
  for (std::size_t i = 1; i < tracked.size(); ++i) {
    const double step =
        (tracked[i].T_base_object.translation() - tracked[i - 1].T_base_object.translation())
            .head<2>()
            .norm();
    const double duration = tracked[i].t - tracked[i - 1].t;
    if (step < std::min(3.0 * tracked[i].position_std, kMinMotionSpeed * duration)) {
      now = {i, i, 0.0};
      continue;
    }
    now.end = i;
    now.length += step;
    if (now.length > longest.length) longest = now;
  }
  return longest;
}

Eigen::Vector3d mean_position(std::span<const TrackedPose> tracked, const Eigen::Vector3d& p_object,
                              double from, double to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const TrackedPose& pose : tracked) {
    if (pose.t < from || pose.t > to) continue;
    sum += pose.T_base_object * p_object;
    count += 1.0;
  }
  return count > 0.0 ? Eigen::Vector3d(sum / count)
                     : Eigen::Vector3d(tracked.front().T_base_object * p_object);
}

}  // namespace

TrackingOffset camera_offset(const InputSeries& series, const std::vector<BodySurface>& surfaces,
                             const PathView& tip, std::span<const Contact> contacts,
                             double slide_half_width) {
  std::vector<const Contact*> pushes;
  double end_std = 0.0;
  for (const Contact& contact : contacts) {
    const bool is_tracked = contact.object && !series.bodies[*contact.object].tracked.empty();
    if (!is_tracked || !begins_in(series, contact)) continue;
    if (!is_usable(contact, tip, series, surfaces)) continue;
    pushes.push_back(&contact);
    end_std = std::max(end_std, slide_end_std(contact, slide_half_width));
  }
  TrackingOffset result;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Sums sums;
    for (const Contact* push : pushes) {
      sums.add(*push, tip, series.bodies[*push->object].tracked, result.offset);
    }
    if (sums.count < kMinPoses || sums.speed_squares <= 0.0) return result;
    result.offset +=
        std::clamp(sums.gradient / sums.speed_squares, -kMaxOffsetStep, kMaxOffsetStep);
    // The std covers that contacts give way and objects stick for many frames.
    result.std =
        std::sqrt(sums.residual_squares / sums.count * sums.correlated) / sums.speed_squares;
    result.std = std::hypot(result.std, sums.bias / sums.speed_squares);
    result.std = std::hypot(result.std, kMotionBias, end_std);
    result.is_known = std::abs(result.offset) < kMaxOffset && result.std < 0.1 * kMaxOffset;
  }
  // At constant speed any delay fits, but the tip would not be at the face.
  const auto distance = [&](double offset) {
    return distance_from_faces(series, surfaces, tip, pushes, offset);
  };
  const bool is_delay = result.is_known && std::abs(result.offset) > kMinStds * result.std;
  if (!is_delay) return result;
  Sums late;
  ShiftFit shifted;
  for (const Contact* push : pushes) {
    const std::span<const TrackedPose> tracked = series.bodies[*push->object].tracked;
    late.add(*push, tip, tracked, result.offset);
    shifted.add(*push, tip, tracked);
  }
  result.is_known = distance(result.offset) <= distance(0.0) && !is_rather_shifted(late, shifted);
  result.is_ambiguous = !result.is_known;
  return result;
}

TimeOffset motion_offset(const InputBody& body, const BodySurface& surface, const PathView& tip,
                         std::span<const Eigen::Vector3d> p_base_tip, double tool_radius) {
  const std::span<const TrackedPose> tracked = body.tracked;
  if (tracked.size() < 10) return {};
  const Motion motion = longest_motion(tracked);
  if (motion.length < kMinPushDisplacement) return {};
  // The slow start and end of a motion are below the noise.
  const double begin = tracked[motion.begin].t - kAroundMotion;
  const double end = tracked[motion.end].t + kAroundMotion;
  // The motion is that of the point that is pushed: the other points of an object that turns are
  // faster or slower.
  const TrackedPose& first = tracked[motion.begin];
  const Eigen::Vector3d p_object = first.T_base_object.inverse() * tip.at(first.t);
  const Eigen::Vector3d from =
      mean_position(tracked, p_object, begin, begin + kAroundMotion - kMotionRange);
  const Eigen::Vector3d displacement =
      mean_position(tracked, p_object, end - kAroundMotion + kMotionRange, end) - from;
  if (displacement.head<2>().norm() < kMinPushDisplacement) return {};
  const Eigen::Vector3d along =
      Eigen::Vector3d(displacement.x(), displacement.y(), 0.0).normalized();
  const double length = displacement.dot(along);
  // The pushed object moves with the tip: correlates its displacement with the tip's, which is
  // clipped to the same range.
  std::vector<double> t_tip, pushed, t_seen, seen;
  std::optional<double> furthest;
  for (std::size_t i = 0; i < tip.t().size(); ++i) {
    if (tip.t()[i] < begin || tip.t()[i] > end) continue;
    t_tip.push_back(tip.t()[i]);
    pushed.push_back(p_base_tip[i].dot(along));
    const bool is_moving = tip.t()[i] > begin + kAroundMotion - kMotionRange &&
                           tip.t()[i] < end - kAroundMotion + kMotionRange;
    if (is_moving) furthest = std::max(furthest.value_or(pushed.back()), pushed.back());
  }
  if (!furthest) return {};
  double reached = 0.0;
  for (double& value : pushed) {
    reached = std::max(reached, std::clamp(value - (*furthest - length), 0.0, length));
    value = reached;
  }
  for (const TrackedPose& pose : tracked) {
    if (pose.t < begin || pose.t > end) continue;
    t_seen.push_back(pose.t);
    seen.push_back((pose.T_base_object * p_object - from).dot(along));
  }
  TimeOffsetOptions options;
  options.range = kMotionRange;
  TimeOffset offset = estimate_time_offset(t_tip, pushed, t_seen, seen, options);
  if (!offset.is_known || offset.correlation < 0.9) return {};
  const auto distance =
      [&, moving = tracked.subspan(motion.begin, motion.end - motion.begin + 1)](double delay) {
        return distance_from_body(body, surface, tip, tool_radius, moving, delay);
      };
  offset.std = std::hypot(offset.std, kMotionBias);
  const bool is_delay = std::abs(offset.offset) > kMinStds * offset.std;
  if (is_delay && distance(offset.offset) > distance(0.0)) return {};
  return offset;
}

}  // namespace pcavr
