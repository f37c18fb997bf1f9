// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  /// By an effect of the information `by` on these sums, marginalised [Woodbury].
  void remove(const PushSums<N>& sums, double by) {
    information -= sums.row * sums.row.transpose() / by;
    weighted -= sums.value / by * sums.row;
    misfit -= sums.value * sums.value / by;
  }
};

/// Covariances of the noises of two columns of a sample, with those of the sample before.
struct NoiseCovariance {
  double own = 0.0;   ///< of this sample's two noises
  double next = 0.0;  ///< of one with the other's of the sample before
};

/// Whitens the samples of one push, in order of time: of each column (of the rows, the value, and
/// the effect that all share), the part that the samples before do not predict, over its std.
/// Friction varies with the place as a first order autoregression along the path (an
/// Ornstein-Uhlenbeck process), beside white noise [Kalman 1960].
template <int N>
class PlaceFilter {
 public:
  using Columns = Eigen::Matrix<double, N + 2, 1>;  ///< row, value, 1

  /// `std` of the friction that varies with the place.
  explicit PlaceFilter(double std) : stationary_(std * std), variance_(stationary_) {}

  struct Whitened {
    Columns columns = Columns::Zero();
    double variance = 1.0;  ///< of the part that is not predicted
    /// What noise of the columns themselves adds to the products that are asked for, on average.
    std::array<double, 2> noise{};
  };
  /// `kept`: correlation of the place's friction with that at the sample before. `noise`: of pairs
  /// of columns.
  [[nodiscard]] Whitened step(const Columns& columns, double variance, double kept,
                              const std::array<NoiseCovariance, 2>& noise) {
    const double after = kept * gain_;  // share of the last sample in the prediction of this one
    predicted_ = kept * predicted_;
    variance_ = kept * kept * variance_ + (1.0 - kept * kept) * stationary_;
    const double total = variance_ + variance;
    Whitened result{(columns - predicted_) / std::sqrt(total), total, {}};
    const double gain = variance_ / total;
    for (std::size_t k = 0; k < noise.size(); ++k) {
      const double cross = after * noise[k].next;
      const double predicted = kept * kept * predicted_noise_[k];
      result.noise[k] = (noise[k].own - 2.0 * cross + predicted) / total;
      predicted_noise_[k] = std::pow(1.0 - gain, 2) * predicted + gain * gain * noise[k].own +
                            2.0 * gain * (1.0 - gain) * cross;
    }
    predicted_ += gain * (columns - predicted_);
    variance_ *= 1.0 - gain;
    gain_ = gain;
    return result;
  }

 private:
  double stationary_;
  double variance_;                          ///< of the place's friction, given the samples so far
  double gain_ = 0.0;                        ///< of the last sample
  Columns predicted_ = Columns::Zero();      ///< of the last sample, by it and those before
  std::array<double, 2> predicted_noise_{};  ///< products of the noises in it
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
