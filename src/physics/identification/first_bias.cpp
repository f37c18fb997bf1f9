// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/first_bias.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

// Duration of the means by which the bias is followed [s]: shorter than the time between contacts.
constexpr double kWindow = 0.05;
// Windows on either side over which the tip's net motion counts, half a second: a contact that is
// modulated returns meanwhile, travel between contacts does not.
constexpr std::size_t kNetWindows = 10;

/// Means over successive windows of equally many samples; the last one has the remainder, too.
struct Means {
  std::size_t width = 0;  ///< samples
  std::vector<Eigen::Vector3d> force;
  std::vector<Eigen::Vector3d> p_base_tip;  ///< in the middle of each window

  Means(std::span<const double> stamps, std::span<const Eigen::Vector3d> samples,
        const PathView& tip)
      : width(static_cast<std::size_t>(std::ceil(kWindow / mean_interval(stamps)))) {
    for (std::size_t i = 0; i + width <= stamps.size(); i += width) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t k = i; k < i + width; ++k) sum += samples[k];
      force.push_back(sum / static_cast<double>(width));
      p_base_tip.push_back(tip.at(stamps[i + width / 2]));
    }
  }

  /// Contact only adds to a force whose gravity and gross bias are removed.
  [[nodiscard]] std::size_t smallest() const {
    const auto least = [](const auto& a, const auto& b) {
      return a.squaredNorm() < b.squaredNorm();
    };
    return static_cast<std::size_t>(std::min_element(force.begin(), force.end(), least) -
                                    force.begin());
  }

  /// The tip's net motion about the i-th window, per window [m].
  [[nodiscard]] double net_displacement(std::size_t i) const {
    const std::size_t first = i - std::min(i, kNetWindows);
    const std::size_t last = std::min(i + kNetWindows, p_base_tip.size() - 1);
    if (last == first) return 0.0;
    return (p_base_tip[last] - p_base_tip[first]).norm() / static_cast<double>(last - first);
  }

  /// Mean of all forces within `max_distance` of the force `one`, which alone would be small by its
  /// noise.
  [[nodiscard]] Eigen::Vector3d level_near(std::size_t one, double max_distance) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (const Eigen::Vector3d& mean : force) {
      if ((mean - force[one]).norm() > max_distance) continue;
      sum += mean;
      count += 1.0;
    }
    return sum / count;
  }
};

/// `bias` after one more mean, by at most `reach` nearer to it. Not faster after a contact that hid
/// the drift: what is near then may be a slow end of the contact.
Eigen::Vector3d followed(const Eigen::Vector3d& bias, const Eigen::Vector3d& mean,
                         double max_distance, double reach) {
  const Eigen::Vector3d off = mean - bias;
  const double distance = off.norm();
  if (distance > max_distance) return bias;
  return distance > reach ? bias + reach / distance * off : mean;
}

}  // namespace

std::vector<Eigen::Vector3d> first_bias(std::span<const double> t,
                                        std::span<const Eigen::Vector3d> force, const PathView& tip,
                                        double max_distance, double max_drift,
                                        double max_cable_stiffness) {
  const Means means(t, force, tip);
  if (means.force.empty()) return {t.size(), Eigen::Vector3d::Zero()};
  const std::size_t start = means.smallest();
  const auto reach = [&](std::size_t i) {
    return max_drift * kWindow + max_cable_stiffness * means.net_displacement(i);
  };
  std::vector<Eigen::Vector3d> levels(means.force.size());
  levels[start] = means.level_near(start, max_distance);
  for (std::size_t i = start + 1; i < levels.size(); ++i) {
    levels[i] = followed(levels[i - 1], means.force[i], max_distance, reach(i));
  }
  for (std::size_t i = start; i-- > 0;) {
    levels[i] = followed(levels[i + 1], means.force[i], max_distance, reach(i));
  }
  std::vector<Eigen::Vector3d> bias(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    bias[i] = levels[std::min(i / means.width, levels.size() - 1)];
  }
  return bias;
}

}  // namespace pcavr
