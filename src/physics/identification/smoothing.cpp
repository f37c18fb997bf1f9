// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

#include "physics/identification/small_solve.hpp"

namespace pcavr {
namespace {

// A quadratic has three coefficients; two more samples make it a fit.
constexpr std::size_t kMinSamples = 5;

/// Sums of powers of u, and of value times powers of u, for the three fits. The weights
/// 1, 1 - u^2 and (1 - u^2)^2 are polynomials, so that their sums are differences of these.
struct Moments {
  std::array<double, 7> powers{};
  std::array<double, 6> values{};

  void add(double u, double value) {
    const double u2 = u * u, u3 = u2 * u, u4 = u2 * u2, u5 = u4 * u;
    powers[0] += 1.0;
    powers[1] += u;
    powers[2] += u2;
    powers[3] += u3;
    powers[4] += u4;
    powers[5] += u5;
    powers[6] += u4 * u2;
    values[0] += value;
    values[1] += u * value;
    values[2] += u2 * value;
    values[3] += u3 * value;
    values[4] += u4 * value;
    values[5] += u5 * value;
  }
};

using Sums = std::span<const double>;
double unweighted(Sums m, std::size_t k) { return m[k]; }
double parabola_weighted(Sums m, std::size_t k) { return m[k] - m[k + 2]; }
double kernel_weighted(Sums m, std::size_t k) { return m[k] - 2.0 * m[k + 2] + m[k + 4]; }

/// Weighted least squares: the coefficients of 1, u, ... under the given weight.
template <int N>
Eigen::Matrix<double, N, 1> fit(const Moments& moments, double (*weighted)(Sums, std::size_t)) {
  Eigen::Matrix<double, N, N> normal;
  Eigen::Matrix<double, N, 1> rhs;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      normal(i, j) =
          weighted(moments.powers, static_cast<std::size_t>(i) + static_cast<std::size_t>(j));
    }
    rhs(i) = weighted(moments.values, static_cast<std::size_t>(i));
  }
  return solve_positive<N>(normal, rhs);
}

/// The window is full when it has no gap longer than half of its half width.
bool is_covered(std::span<const double> t, double at, double half_width) {
  double before = at - half_width;
  for (const double stamp : t) {
    if (stamp - before > 0.5 * half_width) return false;
    before = stamp;
  }
  return at + half_width - before <= 0.5 * half_width;
}

/// The line under the kernel (1 - u^2)^2, at `at`: of values or points.
template <typename Value>
Value fit_value(std::span<const double> t, std::span<const Value> values, double at,
                double half_width) {
  const Value& middle = values[values.size() / 2];  // avoids cancellation where the value is large
  Value wv = 0.0 * middle, wuv = 0.0 * middle;
  const double per_width = 1.0 / half_width;
  double w = 0.0, wu = 0.0, wuu = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double u = (t[i] - at) * per_width;
    const double root = 1.0 - u * u;
    const double weight = root * root, weighted_u = weight * u;
    const Value value = values[i] - middle;
    w += weight;
    wu += weighted_u;
    wuu += weighted_u * u;
    wv += weight * value;
    wuv += weighted_u * value;
  }
  return middle + (wuu * wv - wu * wuv) / (w * wuu - wu * wu);
}

SmoothedSample fit_window(std::span<const double> t, std::span<const double> values, double at,
                          double half_width) {
  if (t.size() < kMinSamples || !is_covered(t, at, half_width)) return {};
  Moments moments;
  const double middle = values[values.size() / 2];  // avoids cancellation where the value is large
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double u = (t[i] - at) / half_width;
    moments.add(u, values[i] - middle);
  }
  SmoothedSample sample;
  sample.value = middle + fit<2>(moments, kernel_weighted)[0];
  sample.rate = fit<3>(moments, parabola_weighted)[1] / half_width;
  sample.acceleration = 2.0 * fit<3>(moments, unweighted)[2] / (half_width * half_width);
  sample.is_valid = true;
  return sample;
}

std::size_t index_of(std::span<const double>::iterator position, std::span<const double> t) {
  return static_cast<std::size_t>(std::distance(t.begin(), position));
}

/// Indices [begin, end) of a window's samples.
struct Window {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// Empty beyond the ends, where no samples would be on one side.
Window window_at(std::span<const double> t, double at, double half_width) {
  if (t.empty() || at - half_width < t.front() - 1e-9 || at + half_width > t.back() + 1e-9)
    return {};
  const std::size_t begin =
      index_of(std::upper_bound(t.begin(), t.end(), at - half_width * (1.0 - 1e-9)), t);
  const std::size_t end =
      index_of(std::lower_bound(t.begin(), t.end(), at + half_width * (1.0 - 1e-9)), t);
  return end > begin ? Window{begin, end} : Window{};
}

/// window_at() for one instant after another, without a search for each where they ascend.
class MovingWindow {
 public:
  MovingWindow(std::span<const double> t, double half_width) : t_(t), half_width_(half_width) {}

  Window at(double instant) {
    if (window_.size() == 0 || instant < last_) {
      window_ = window_at(t_, instant, half_width_);
    } else if (instant + half_width_ > t_.back() + 1e-9) {
      window_ = {};
    } else {
      const double reach = half_width_ * (1.0 - 1e-9);
      while (window_.begin < t_.size() && t_[window_.begin] <= instant - reach) ++window_.begin;
      window_.end = std::max(window_.begin, window_.end);
      while (window_.end < t_.size() && t_[window_.end] < instant + reach) ++window_.end;
    }
    last_ = instant;
    return window_;
  }

 private:
  std::span<const double> t_;
  double half_width_;
  Window window_;
  double last_ = 0.0;
};

SmoothedSample fit_at(std::span<const double> t, std::span<const double> values, double at,
                      double half_width) noexcept {
  const Window window = window_at(t, at, half_width);
  return fit_window(t.subspan(window.begin, window.size()),
                    values.subspan(window.begin, window.size()), at, half_width);
}

void require_series(std::size_t stamps, std::size_t values, double half_width) {
  PCAVR_REQUIRE(stamps == values, stamps, values);
  PCAVR_REQUIRE(half_width > 0.0, half_width);
}

/// Empty where the window is not full.
template <typename Value>
std::optional<Value> value_in(const Window& window, std::span<const double> t,
                              std::span<const Value> values, double at, double half_width) {
  const std::span<const double> stamps = t.subspan(window.begin, window.size());
  if (stamps.size() < kMinSamples || !is_covered(stamps, at, half_width)) return std::nullopt;
  return fit_value(stamps, values.subspan(window.begin, window.size()), at, half_width);
}

SmoothedSample sample_of(const std::optional<double>& value) {
  return {.value = value.value_or(0.0), .is_valid = value.has_value()};
}

}  // namespace

SmoothedSample smooth_at(std::span<const double> t, std::span<const double> values, double at,
                         double half_width) {
  require_series(t.size(), values.size(), half_width);
  return fit_at(t, values, at, half_width);
}

std::vector<SmoothedSample> smooth(std::span<const double> t, std::span<const double> values,
                                   std::span<const double> at, double half_width) {
  require_series(t.size(), values.size(), half_width);
  std::vector<SmoothedSample> samples;
  samples.reserve(at.size());
  MovingWindow windows(t, half_width);
  for (const double instant : at) {
    const Window window = windows.at(instant);
    samples.push_back(fit_window(t.subspan(window.begin, window.size()),
                                 values.subspan(window.begin, window.size()), instant, half_width));
  }
  return samples;
}

SmoothedSample smooth_value_at(std::span<const double> t, std::span<const double> values, double at,
                               double half_width) {
  require_series(t.size(), values.size(), half_width);
  return sample_of(value_in(window_at(t, at, half_width), t, values, at, half_width));
}

std::optional<Eigen::Vector3d> smooth_point_at(std::span<const double> t,
                                               std::span<const Eigen::Vector3d> points, double at,
                                               double half_width) {
  require_series(t.size(), points.size(), half_width);
  return value_in(window_at(t, at, half_width), t, points, at, half_width);
}

std::vector<SmoothedSample> smooth_values(std::span<const double> t, std::span<const double> values,
                                          std::span<const double> at, double half_width) {
  require_series(t.size(), values.size(), half_width);
  std::vector<SmoothedSample> samples;
  samples.reserve(at.size());
  MovingWindow windows(t, half_width);
  for (const double instant : at) {
    samples.push_back(sample_of(value_in(windows.at(instant), t, values, instant, half_width)));
  }
  return samples;
}

double correlated_samples(double half_width, double interval) {
  PCAVR_REQUIRE(interval > 0.0, interval);
  // Equivalent noise width of the kernel (1 - u^2)^2: (int k)^2 / int k^2 = 1.4 half widths.
  return std::max(1.0, 1.4 * half_width / interval);
}

CausalFilter::CausalFilter(double half_width, double rate, double force_noise,
                           const SpikeOptions& spikes)
    : half_width_(half_width),
      interval_(1.0 / rate),
      force_noise_(force_noise),
      spike_threshold_(spikes.threshold) {
  PCAVR_REQUIRE(half_width > 0.0 && rate > 0.0 && force_noise > 0.0, half_width, rate);
  PCAVR_REQUIRE(half_width * rate >= 2.5, half_width, rate);
  // Twice as many as the window needs at the stated rate, for timestamps that cluster.
  const auto capacity = 4 * static_cast<std::size_t>(std::ceil(half_width * rate)) + 8;
  for (std::vector<double>* ring : {&t_, &position_, &force_}) ring->resize(capacity);
}

std::optional<CausalFilter::Output> CausalFilter::step(double t, double position,
                                                       double force) noexcept {
  if (!std::isfinite(t) || !std::isfinite(position) || !std::isfinite(force)) return {};
  if (count_ > 0 && t <= t_[count_ - 1]) return {};
  if (count_ == t_.size()) {
    for (std::vector<double>* ring : {&t_, &position_, &force_}) {
      std::copy(std::next(ring->begin()), ring->end(), ring->begin());
    }
    --count_;
  }
  t_[count_] = t;
  position_[count_] = position;
  force_[count_] = force;
  ++count_;
  if (count_ < 5) return {};
  // The sample two back now has two neighbours on either side: Hampel filter over five samples.
  double* const force_end = force_.data() + count_;
  double five[5];
  std::copy(force_end - 5, force_end, five);
  std::nth_element(five, five + 2, five + 5);
  const double middle = five[2];
  for (double& value : five) value = std::abs(value - middle);
  std::nth_element(five, five + 2, five + 5);
  const double local_std = std::max(kStdOverMad * five[2], force_noise_);
  if (std::abs(force_end[-3] - middle) > spike_threshold_ * local_std) force_end[-3] = middle;
  const std::size_t ready = count_ - 2;
  const double at = t_[ready - 1] - half_width_;
  const std::span<const double> stamps(t_.data(), ready);
  const SmoothedSample x = fit_at(stamps, {position_.data(), ready}, at, half_width_);
  const SmoothedSample f = fit_at(stamps, {force_.data(), ready}, at, half_width_);
  if (!x.is_valid || !f.is_valid) return {};
  return Output{at, x.value, x.rate, x.acceleration, f.value};
}

}  // namespace pcavr
