// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "step_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace pcavr {
namespace {

constexpr double kMaxStep = 1.0;           ///< [s] that is searched for
constexpr double kLagStep = 0.5;           ///< [half windows] of the search's offsets
constexpr std::size_t kMaxScanned = 4000;  ///< samples of the search
constexpr std::size_t kMaxParts = 60;      ///< of the record, between which steps are searched for
constexpr double kMinPart = 0.5;           ///< [s] of their length
constexpr double kMinKnown = 0.7;          ///< of a side's samples that are compared at an offset
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What the best turn leaves of the sum of |a - R b|^2, from sums.
struct Moments {
  Eigen::Matrix3d ab = Eigen::Matrix3d::Zero();
  double squares = 0.0, count = 0.0;

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    ab += a * b.transpose();
    squares += a.squaredNorm() + b.squaredNorm();
    count += 1.0;
  }
  Moments& operator+=(const Moments& other) {
    ab += other.ab;
    squares += other.squares;
    count += other.count;
    return *this;
  }
  Moments operator-(const Moments& other) const {
    return {ab - other.ab, squares - other.squares, count - other.count};
  }
  [[nodiscard]] double rest() const {
    return squares - 2.0 * (turn_of(ab).transpose() * ab).trace();
  }
};

/// An offset, and what it leaves of a part of the record.
struct PartFit {
  double offset = 0.0, rest = kInfinity;
};

/// The least of `rests` by a parabola through its neighbours.
PartFit vertex_of(std::span<const double> rests, double first_offset, double step) {
  const auto least = std::min_element(rests.begin(), rests.end());
  const auto i = static_cast<std::size_t>(least - rests.begin());
  PartFit fit{first_offset + static_cast<double>(i) * step, *least};
  if (i == 0 || i + 1 == rests.size()) return fit;
  const double fall = rests[i - 1] - *least, rise = rests[i + 1] - *least;
  if (!std::isfinite(fall + rise) || !(fall + rise > 0.0)) return fit;
  const double shift = 0.5 * (fall - rise) / (fall + rise);
  fit.offset += shift * step;
  fit.rest -= 0.25 * (fall - rise) * shift;
  return fit;
}

/// Sums of the record's parts at all offsets about one.
class StepScan {
 public:
  StepScan(const VelocitySignal& a, const VelocitySamples& samples, double centre, double drift)
      : a_(a), lag_step_(kLagStep * a.half_window()), first_offset_(centre - kMaxStep) {
    const double middle = 0.5 * (samples.t.front() + samples.t.back());
    const std::size_t stride = samples.t.size() / kMaxScanned + 1;
    for (std::size_t i = 0; i < samples.t.size(); i += stride) {
      t_.push_back(samples.t[i]);
      on_a_.push_back(samples.t[i] + drift * (samples.t[i] - middle));
      b_.push_back(samples.b[i]);
    }
    const double span = t_.back() - t_.front();
    const auto parts = static_cast<std::size_t>(span / kMinPart);
    parts_ = std::clamp<std::size_t>(parts, 2, kMaxParts);
    sum_up();
  }

  [[nodiscard]] SteppedOffsets best() const {
    SteppedOffsets best;
    double least = kInfinity;
    for (std::size_t part = 1; part < parts_; ++part) {
      const PartFit before = fit(0, part), after = fit(part, parts_);
      if (!(before.rest + after.rest < least)) continue;
      least = before.rest + after.rest;
      best = {begin_of(part), before.offset, after.offset};
    }
    if (std::isfinite(least)) best.at = instant_of(best);
    return best;
  }

 private:
  [[nodiscard]] double begin_of(std::size_t part) const {
    return t_.front() +
           (t_.back() - t_.front()) * static_cast<double>(part) / static_cast<double>(parts_);
  }

  /// a's velocities at all offsets of all samples, from a table.
  void sum_up() {
    const auto lags = static_cast<std::size_t>(2.0 * kMaxStep / lag_step_) + 1;
    sums_.assign(lags, std::vector<Moments>(parts_ + 1));
    counts_.assign(parts_ + 1, 0.0);
    const std::vector<std::optional<Eigen::Vector3d>> table = table_of(lags);
    for (std::size_t i = 0; i < t_.size(); ++i) {
      const std::size_t part = part_of(t_[i]);
      counts_[part + 1] += 1.0;
      const double place = (on_a_[i] - on_a_.front()) / lag_step_;
      const auto row = static_cast<std::size_t>(place);
      const double share = place - static_cast<double>(row);
      for (std::size_t lag = 0; lag < lags; ++lag) {
        const auto &low = table[row + lag], &high = table[row + lag + 1];
        if (!low || !high) continue;
        sums_[lag][part + 1].add((1.0 - share) * *low + share * *high, b_[i]);
      }
    }
    for (std::size_t part = 0; part < parts_; ++part) {
      counts_[part + 1] += counts_[part];
      for (std::vector<Moments>& of_lag : sums_) of_lag[part + 1] += of_lag[part];
    }
  }

  [[nodiscard]] std::vector<std::optional<Eigen::Vector3d>> table_of(std::size_t lags) const {
    const double begin = on_a_.front() + first_offset_;
    const auto rows =
        static_cast<std::size_t>((on_a_.back() - on_a_.front()) / lag_step_) + lags + 2;
    std::vector<std::optional<Eigen::Vector3d>> table;
    table.reserve(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      table.push_back(a_.at(begin + static_cast<double>(row) * lag_step_));
    }
    return table;
  }

  [[nodiscard]] std::size_t part_of(double t) const {
    const double share = (t - t_.front()) / (t_.back() - t_.front());
    return std::min(static_cast<std::size_t>(share * static_cast<double>(parts_)), parts_ - 1);
  }

  /// The best offset of the parts [from, to).
  [[nodiscard]] PartFit fit(std::size_t from, std::size_t to) const {
    const double samples = counts_[to] - counts_[from];
    std::vector<double> rests;
    rests.reserve(sums_.size());
    for (const std::vector<Moments>& of_lag : sums_) {
      const Moments sum = of_lag[to] - of_lag[from];
      const bool is_known = sum.count > 0.0 && sum.count >= kMinKnown * samples;
      rests.push_back(is_known ? sum.rest() * samples / sum.count : kInfinity);
    }
    return vertex_of(rests, first_offset_, lag_step_);
  }

  /// The instant from which the second offset explains more than the first, to a sample.
  [[nodiscard]] double instant_of(const SteppedOffsets& offsets) const {
    std::vector<std::optional<Eigen::Vector3d>> before, after;
    Moments sum;
    for (std::size_t i = 0; i < t_.size(); ++i) {
      before.push_back(a_.at(on_a_[i] + offsets.before));
      after.push_back(a_.at(on_a_[i] + offsets.after));
      const auto& used = t_[i] < offsets.at ? before.back() : after.back();
      if (used) sum.add(*used, b_[i]);
    }
    const Eigen::Matrix3d R = turn_of(sum.ab);
    double gain = 0.0, least = 0.0, at = offsets.at;
    for (std::size_t i = 0; i < t_.size(); ++i) {
      if (!before[i] || !after[i]) continue;
      const Eigen::Vector3d turned = R * b_[i];
      gain += (*before[i] - turned).squaredNorm() - (*after[i] - turned).squaredNorm();
      if (gain < least) least = gain, at = t_[i];
    }
    return at;
  }

  const VelocitySignal& a_;
  double lag_step_, first_offset_;  ///< [s]
  std::size_t parts_ = 0;
  std::vector<double> t_, on_a_;  ///< [s] of b's stamps; with the drift, without the offset
  std::vector<Eigen::Vector3d> b_;
  std::vector<double> counts_;              ///< samples before each part
  std::vector<std::vector<Moments>> sums_;  ///< by offset, of all parts before each
};

}  // namespace

SteppedOffsets scan_for_step(const VelocitySignal& a, const VelocitySamples& samples, double centre,
                             double drift) {
  return StepScan(a, samples, centre, drift).best();
}

}  // namespace pcavr
