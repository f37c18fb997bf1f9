// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace pcavr::detail {

/// Weighted sums over the samples of one push: of weights, rows, and values.
template <int N>
struct PushSums {
  double weight = 0.0;
  Eigen::Matrix<double, N, 1> row = Eigen::Matrix<double, N, 1>::Zero();
  double value = 0.0;

  PushSums& operator*=(double factor) {
    weight *= factor;
    row *= factor;
    value *= factor;
    return *this;
  }
};

/// Normal equations of weighted least squares in N unknowns, and what the evidence needs.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> information = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> weighted = Eigen::Matrix<double, N, 1>::Zero();
  double misfit = 0.0;           ///< weighted sum of squared values
  double log_determinant = 0.0;  ///< of the values' covariance

  /// Marginalises an effect of the information `by` on these sums [Woodbury].
  void remove(const PushSums<N>& sums, double by) {
    const Eigen::Matrix<double, N, 1> scaled = sums.row / by;
    information.noalias() -= scaled * sums.row.transpose();
    weighted -= sums.value * scaled;
    misfit -= sums.value * sums.value / by;
  }
};

/// Covariance of two noises of a sample (of a column with itself: its variance).
struct NoiseCovariance {
  double own = 0.0;   ///< of this sample's two noises
  double next = 0.0;  ///< of one with the other's of the sample before
};

/// Whitens the samples of one push, in order of time: of each column (of the rows, the value, and
/// the effect that all share), the part that the samples before do not predict, over its std.
/// Friction varies with the place as a first order autoregression along the path (an
/// Ornstein-Uhlenbeck process). The noise beside it is a first order moving average: smoothing
/// windows overlap those of the samples before [Kalman 1960; Box & Jenkins 1976, ch. 3]. The state
/// is the friction of the place and the noise's last shock, of std 1.
template <int N>
class PlaceFilter {
 public:
  using Columns = Eigen::Matrix<double, N + 2, 1>;  ///< row, value, 1

  /// `std` of the friction that varies with the place.
  explicit PlaceFilter(double std) : stationary_(std * std) {
    covariance_(kPlace, kPlace) = stationary_;
  }

  struct Whitened {
    Columns columns = Columns::Zero();
    double variance = 1.0;  ///< of the part that is not predicted
    /// Mean contribution of the columns' own noise to the products that are asked for.
    std::array<double, 2> noise{};
  };
  /// `value`: of the value's noise, which may be none; its `next` is 0 in a push's first sample.
  /// `kept`: correlation of the place's friction with that at the sample before. `noise`: of pairs
  /// of columns.
  [[nodiscard]] Whitened step(const Columns& columns, const NoiseCovariance& value, double kept,
                              const std::array<NoiseCovariance, 2>& noise) {
    // The noise is `before` times the last shock, and `fresh_` times the present one.
    const double max_before = kMaxSharedStd * std::sqrt(value.own);
    const double before =
        fresh_ > 0.0 ? std::clamp(value.next / fresh_, -max_before, max_before) : 0.0;
    fresh_ = std::sqrt(value.own - before * before);
    const State by(kept, before);  // of the state before this sample
    const double new_place = (1.0 - kept * kept) * stationary_;
    const double total = by.dot(covariance_ * by) + new_place + fresh_ * fresh_;
    const Columns unpredicted = columns - estimate_ * by;
    Whitened result{unpredicted / std::sqrt(total), total, {}};
    const double place_with_value = kept * covariance_.row(kPlace).dot(by) + new_place;
    const State last_gain = gain_;
    gain_ = State(place_with_value, fresh_) / total;
    propagate_noise(by, kept, total, last_gain, noise, result);
    estimate_.col(kPlace) *= kept;
    estimate_.col(kShock).setZero();
    estimate_ += unpredicted * gain_.transpose();
    const double place = kept * kept * covariance_(kPlace, kPlace) + new_place;
    covariance_ = State(place, 1.0).asDiagonal();
    covariance_ -= total * gain_ * gain_.transpose();
    return result;
  }

 private:
  enum Part { kPlace, kShock };
  using State = Eigen::Vector2d;
  using StateCovariance = Eigen::Matrix2d;

  /// Largest share of a noise's std in common with the sample before: with a larger one, the moving
  /// average has no inverse.
  static constexpr double kMaxSharedStd = 0.7;

  /// Products of the noises in the unpredicted part, and in the estimate.
  void propagate_noise(const State& by, double kept, double total, const State& last_gain,
                       const std::array<NoiseCovariance, 2>& noise, Whitened& result) {
    StateCovariance transition = State(kept, 0.0).asDiagonal();
    transition -= gain_ * by.transpose();
    for (std::size_t k = 0; k < noise.size(); ++k) {
      StateCovariance& products = noise_[k];
      const double cross = by.dot(last_gain) * noise[k].next;
      result.noise[k] = (noise[k].own - 2.0 * cross + by.dot(products * by)) / total;
      const StateCovariance shared = noise[k].next * transition * last_gain * gain_.transpose();
      products = transition * products * transition.transpose() + shared + shared.transpose() +
                 noise[k].own * gain_ * gain_.transpose();
    }
  }

  double stationary_;
  double fresh_ = 1.0;                                    ///< std of the last sample's own shock
  StateCovariance covariance_ = StateCovariance::Zero();  ///< given the samples so far
  State gain_ = State::Zero();                            ///< of the last sample
  Eigen::Matrix<double, N + 2, 2> estimate_ = Eigen::Matrix<double, N + 2, 2>::Zero();
  std::array<StateCovariance, 2> noise_{StateCovariance::Zero(), StateCovariance::Zero()};
};

/// Scatter that all samples of a push share.
struct PushScatter {
  double bias_std = 0.0;     ///< independent from push to push
  double std = 0.0;          ///< > 0; of successive pushes with ...
  double correlation = 0.0;  ///< ... this correlation, which decays with their distance, in [0, 1)
};

/// Marginalises the effects of all pushes, in order of time. Their precision is tridiagonal [first
/// order autoregression], which one elimination from the first to the last push solves.
template <int N>
void marginalise_pushes(const std::vector<PushSums<N>>& pushes, const PushScatter& scatter,
                        NormalEquations<N>& equations) {
  const double bias = scatter.bias_std * scatter.bias_std;
  const double rho = scatter.correlation;
  const double innovation = scatter.std * scatter.std * (1.0 - rho * rho);
  const double beside = -rho / innovation;
  PushSums<N> before;  // eliminated; its weight is the pivot
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    PushSums<N> sums = pushes[i];
    const double gain = 1.0 + bias * sums.weight;
    if (bias > 0.0) equations.remove(sums, gain / bias);
    equations.log_determinant += std::log(gain);
    sums *= 1.0 / gain;
    const bool is_inside = i > 0 && i + 1 < pushes.size();
    const bool is_single = pushes.size() == 1;
    const double own = is_inside ? 1.0 + rho * rho : is_single ? 1.0 - rho * rho : 1.0;
    sums.weight += own / innovation;
    if (i > 0) {
      const double share = beside / before.weight;
      sums.weight -= share * beside;
      sums.row -= share * before.row;
      sums.value -= share * before.value;
    }
    equations.remove(sums, sums.weight);
    equations.log_determinant += std::log(sums.weight * innovation);
    before = sums;
  }
  if (!pushes.empty()) equations.log_determinant -= std::log1p(-rho * rho);
}

}  // namespace pcavr::detail
