// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/rests.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

// Duration of the means [s] in which a force that a contact leaves below its threshold is searched;
// and the number of stds above the least mean from which on it is such a force: the least lies some
// two stds below the bias.
constexpr double kRestWindow = 0.05;
constexpr double kRestStds = 5.0;

/// Means of the force over successive windows of `width` samples, from a contact on.
struct WindowMeans {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force;
  std::size_t width = 0;

  void reverse() {
    std::reverse(t.begin(), t.end());
    std::reverse(force.begin(), force.end());
  }

  /// The number of windows that still have the force of the contact along `direction`: more than
  /// the bias can be, which drifts by at most `max_drift` [N/s] to the windows after. `noise` is
  /// that of one sample [N].
  [[nodiscard]] std::size_t count_rest(const Eigen::Vector3d& direction, double noise,
                                       double max_drift) const {
    std::vector<double> along;
    along.reserve(force.size());
    for (const Eigen::Vector3d& mean : force) along.push_back(mean.dot(direction));
    std::vector<double> max_bias = along;
    for (std::size_t i = along.size(); i-- > 1;) {
      const double step = max_drift * std::abs(t[i] - t[i - 1]);
      max_bias[i - 1] = std::min(max_bias[i - 1], max_bias[i] + step);
    }
    const double mean_noise =
        std::max(noise / std::sqrt(static_cast<double>(width)), estimate_noise_std(along));
    std::size_t count = 0;
    while (count < along.size() && along[count] > max_bias[count] + kRestStds * mean_noise) ++count;
    // The window in which the contact ends is included.
    return count > 0 ? std::min(count + 1, along.size()) : 0;
  }
};

WindowMeans window_means(std::span<const double> t, std::span<const Eigen::Vector3d> force,
                         const SampleRange& range) {
  WindowMeans means;
  means.width = static_cast<std::size_t>(std::ceil(kRestWindow / mean_interval(t)));
  for (std::size_t i = range.begin; i + means.width <= range.end; i += means.width) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = i; k < i + means.width; ++k) sum += force[k];
    means.t.push_back(t[i]);
    means.force.push_back(sum / static_cast<double>(means.width));
  }
  return means;
}

Eigen::Vector3d direction_of(std::span<const Eigen::Vector3d> force, const SampleRange& range) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = range.begin; i < range.end; ++i) sum += force[i];
  return sum.normalized();
}

}  // namespace

void exclude_rests(std::span<const double> t, std::span<const Eigen::Vector3d> force,
                   std::span<const SampleRange> contacts, double noise, double max_drift,
                   std::vector<bool>& is_free) {
  const auto exclude = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) is_free[i] = false;
  };
  for (std::size_t c = 0; c <= contacts.size(); ++c) {
    const SampleRange gap{c > 0 ? contacts[c - 1].end : 0,
                          c < contacts.size() ? contacts[c].begin : t.size()};
    WindowMeans means = window_means(t, force, gap);
    const auto rest_of = [&](const SampleRange& contact) {
      return means.width * means.count_rest(direction_of(force, contact), noise, max_drift);
    };
    if (c > 0) exclude(gap.begin, gap.begin + rest_of(contacts[c - 1]));
    if (c == contacts.size()) continue;
    means.reverse();
    const std::size_t covered = gap.begin + means.width * means.force.size();
    if (const std::size_t rest = rest_of(contacts[c]); rest > 0) exclude(covered - rest, gap.end);
  }
}

}  // namespace pcavr
