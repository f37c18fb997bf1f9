// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_signals.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>

#include "pcavr/core/median.hpp"

namespace pcavr {
namespace {

/// No tip is thrown about like this: at 500 Hz it makes a millimetre off the way.
constexpr double kLargestAcceleration = 250.0;  // [m/s^2]
// Between the softest foam and what no arm holds against [N/m].
constexpr double kLeastStiffness = 20.0;
constexpr double kGreatestStiffness = 5e6;
constexpr double kGreatestForce = 2000.0;  // [N] beyond what tools are pushed with by arms
/// Mean cosine between force and motion below which the two do not belong together.
constexpr double kLeastAgreement = 0.5;

std::string printed(const char* format, double a, double b = 0.0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

/// How the tip went while one contact was loaded.
struct Loading {
  double agreement = 0.0;  ///< cosine between the force and the tip's way until the peak
  double stiffness = 0.0;  ///< [N/m] chord from touch to the peak, signed by the agreement
};

std::optional<Loading> loading_of(const ContactEpisode& episode, const PathView& tip) {
  if (episode.t.empty()) return std::nullopt;
  // Until most of the peak: a slide goes on at about that force.
  std::size_t last = 0;
  while (last + 1 < episode.t.size() &&
         (episode.t[last] < episode.begin || episode.force[last] < 0.8 * episode.peak_force)) {
    ++last;
  }
  const Eigen::Vector3d way = tip.at(episode.t[last]) - tip.at(episode.begin);
  constexpr double kLeastWay = 2e-4;  // [m] several noises of the tip
  if (way.norm() < kLeastWay) return std::nullopt;
  const double along = way.dot(episode.direction_base);
  return Loading{along / way.norm(), 0.8 * episode.peak_force / along};
}

}  // namespace

std::vector<Eigen::Vector3d> without_spikes(std::span<const Eigen::Vector3d> points) {
  // Only what is far out: a tip's way bends, and its noise is taken care of by the smoothing.
  constexpr SpikeOptions kFarOut{.half_window = 3, .deviations = 12.0};
  std::vector<Eigen::Vector3d> clean(points.begin(), points.end());
  for (int axis = 0; axis < 3; ++axis) {
    const DespikedSignal signal = remove_spikes(axis_of(points, axis), kFarOut);
    for (const std::size_t i : signal.spikes) clean[i][axis] = signal.values[i];
  }
  return clean;
}

std::vector<double> find_jumps(std::span<const double> t, std::span<const Eigen::Vector3d> points) {
  std::vector<double> jumps;
  if (points.size() < 8) return jumps;
  double noise = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    noise = std::max(noise, noise_deviation(axis_of(points, axis)));
  }
  for (std::size_t i = 2; i + 2 < points.size(); ++i) {
    // The step from i - 1 to i against the two around it.
    const double dt = t[i] - t[i - 1];
    const Eigen::Vector3d before = (points[i - 1] - points[i - 2]) / (t[i - 1] - t[i - 2]);
    const Eigen::Vector3d after = (points[i + 1] - points[i]) / (t[i + 1] - t[i]);
    const Eigen::Vector3d excess = points[i] - points[i - 1] - 0.5 * dt * (before + after);
    const double allowed = 12.0 * noise + kLargestAcceleration * dt * dt;
    const bool is_known = !jumps.empty() && t[i] - jumps.back() < 3.5 * dt;
    if (excess.norm() > allowed && !is_known) jumps.push_back(t[i]);
  }
  return jumps;
}

std::optional<Error> contradiction(const Segmentation& found, const PathView& tip) {
  std::vector<double> stiffness;
  double peak = 0.0;
  for (const ContactEpisode& e : found.contacts) peak = std::max(peak, e.peak_force);
  if (peak > kGreatestForce) {
    return Error{.message = printed("the force goes up to %.3g N, which no arm pushes with", peak),
                 .hint = "write newtons (is it in millinewtons?)"};
  }
  for (const bool is_press : {true, false}) {
    double sum = 0.0, count = 0.0;
    for (const ContactEpisode& episode : found.contacts) {
      if ((episode.kind == ContactKind::press) != is_press) continue;
      const std::optional<Loading> loading = loading_of(episode, tip);
      if (!loading) continue;
      sum += loading->agreement;
      count += 1.0;
      stiffness.push_back(std::abs(loading->stiffness));
    }
    if (count == 0.0 || sum / count > kLeastAgreement) continue;
    const std::string where = (is_press ? "presses" : "pushes") +
                              printed(" (mean cosine %.2f over %.0f contacts)", sum / count, count);
    if (sum / count < -kLeastAgreement) {
      return Error{
          .message =
              "the force has the wrong sign: it points against the tool's motion in " + where,
          .hint = "write the force that the tool exerts, not the one that it feels"};
    }
    return Error{.message = "the force does not go with the tool's motion in " + where,
                 .hint = "write it in base axes"};
  }
  if (stiffness.empty()) return std::nullopt;
  const double middle = median(stiffness);
  if (middle >= kLeastStiffness && middle <= kGreatestStiffness) return std::nullopt;
  return Error{
      .message = printed("force and motion make contacts of %.3g N/m, which no object has", middle),
      .hint = "write newtons and metres"};
}

}  // namespace pcavr
