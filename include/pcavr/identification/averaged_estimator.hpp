// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "pcavr/identification/estimator.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct AveragingOptions {
  AveragingOptions();
  double medium_forgetting;  ///< in (0, 1): lambda of the estimator with a medium memory
  double fast_forgetting;    ///< of the fast one
  double fastest_forgetting;
  /// In (0, 1]: factor per sample by which earlier errors count less in the weights.
  double weight_forgetting;
  /// Age of the parameters whose errors are compared, in `correlated_samples`.
  double lag;
};
[[nodiscard]] OptionSection section_of(AveragingOptions& options);

/// affRLS [paper C]: recursive least squares whose forgetting factor follows the prediction errors
/// over a neighbour window. Paper C's law of lambda is lost; this one is dynamic model averaging
/// [Raftery, Karny & Ettler 2010, Online prediction under model uncertainty via dynamic model
/// averaging]: four estimators run side by side, one with the unity zone (EstimationMethod::
/// adaptive) and three with constant factors, weighted by
///
///     log w_i <- alpha log w_i - e_i^2 / (2 c s^2)
///
/// with s^2 the smallest of their squared errors, averaged, and c the correlated samples. The unity
/// zone alone takes a slow drift of the parameters for noise; constant factors alone are either
/// noisy or late. e_i is the error of parameters that are one filter width old: a short memory
/// predicts the correlated noise of a filtered signal itself, and would always seem best.
///
/// For signals whose parameters may change; where they are constant, as in fits of one press,
/// EstimationMethod::adaptive averages over more samples. Units: the caller's. Threads: one writer.
/// step() neither allocates nor throws.
template <int N>
class AveragedEstimator {
 public:
  /// Throws ContractError for an option out of its range. `options.method` is not used.
  explicit AveragedEstimator(const EstimatorOptions<N>& options = {},
                             const AveragingOptions& averaging = {});
  AveragedEstimator(AveragedEstimator&&) noexcept;
  AveragedEstimator& operator=(AveragedEstimator&&) noexcept;
  ~AveragedEstimator();

  /// `forgetting` is the weighted mean of the estimators'.
  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept;

  /// Weighted means; the variance includes the differences between the estimators. Excitation and
  /// samples are those of the estimator with the largest weight.
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept;
  [[nodiscard]] std::array<double, N> parameters() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

extern template class AveragedEstimator<1>;
extern template class AveragedEstimator<2>;
extern template class AveragedEstimator<3>;
extern template class AveragedEstimator<4>;

}  // namespace pcavr
