// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

namespace pcavr {

struct OptionSection;  // core/options.hpp
namespace detail {
template <int N>
class Memory;
}  // namespace detail

/// The way in which an estimator forgets old samples.
enum class EstimationMethod {
  block,        ///< BSLS: least squares over a sliding window of the last `window` samples
  exponential,  ///< EWRLS: exponentially weighted, `forgetting`^age
  adaptive,     ///< affRLS for constant parameters: factor 1 until a change (unity zone)
  averaged      ///< affRLS for changing parameters: weighted mean of several memories
};

/// Options of EstimationMethod::averaged.
struct AveragingOptions {
  AveragingOptions();
  double medium_forgetting;  ///< in (0, 1): lambda of the estimator with a medium memory
  double fast_forgetting;    ///< of the fast one
  double fastest_forgetting;
  /// Factor per sample by which earlier errors count less in the weights, in (0, 1].
  double weight_forgetting;
  double sharpness;  ///< q > 0: factor of the errors in the weights
  /// Age of the parameters whose errors are compared, in `correlated_samples`.
  double lag;
};
[[nodiscard]] OptionSection section_of(AveragingOptions& options);

/// N is the number of parameters, 1 to 4.
template <int N>
struct EstimatorOptions {
  EstimatorOptions();
  EstimationMethod method;  ///< adaptive
  /// Typical magnitude of each regressor, in its own unit, > 0. It only conditions the arithmetic
  /// and gives `prior_information` its meaning.
  std::array<double, N> scale;
  int window;         ///< samples of a block, >= N + 1
  double forgetting;  ///< exponential: factor in (0, 1]; the larger, the longer the memory
  /// adaptive: in (0, 1); 1 / (1 - this) samples is the memory right after a change
  double min_forgetting;
  int error_window;  ///< adaptive: samples the squared error is averaged over
  /// Standard deviation of the measured value's noise. Empty: estimated online, from errors clipped
  /// at three stds. Give it where the model may be wrong: an estimated one includes the model's
  /// misfit in the long run.
  std::optional<double> noise_std;
  /// Minimum information kept on each scaled parameter; P stays below its inverse.
  double prior_information;
  /// Minimum rms of the part of this regressor that the others do not explain, in its own unit.
  /// Below it the parameter counts as not excited (no persistent excitation). Set it to what the
  /// regressor's own noise can cause.
  std::array<double, N> min_excitation;
  /// Number of successive samples that count as one independent sample (filtered noise is
  /// correlated), >= 1; widens the stds by its square root.
  double correlated_samples;
  AveragingOptions averaging;  ///< averaged: see EstimationMethod
};
/// The options without those of `averaging`, which have their own section.
template <int N>
[[nodiscard]] OptionSection section_of(EstimatorOptions<N>& options);
extern template struct EstimatorOptions<1>;
extern template struct EstimatorOptions<2>;
extern template struct EstimatorOptions<3>;
extern template struct EstimatorOptions<4>;

template <int N>
struct ParameterEstimate {
  std::array<double, N> value = {};
  std::array<double, N> std = {};  ///< standard deviation; infinite before N + 1 samples
  /// False: the samples in memory do not separate this parameter from the others, or from noise.
  std::array<bool, N> is_excited = {};
  double residual_variance = 0.0;  ///< of the measured value about the model, its unit squared
  double samples = 0.0;            ///< in memory, weighted
};

/// Result of one sample.
struct EstimatorStep {
  double prediction = 0.0;  ///< by the parameters as they were before this sample
  double error = 0.0;       ///< measured - prediction
  double forgetting = 1.0;  ///< lambda used
  bool was_used = false;    ///< false: not finite or out of range; nothing was changed
};

/// Linear parameters y = phi . theta, sample by sample, by the methods behind one interface.
///
/// Each memory keeps the information matrix R (the inverse of P) in scaled units:
///
///     R <- lambda R + (1 - lambda) delta I + phi phi',   theta <- theta + R^-1 phi (y - phi'theta)
///
/// the leak delta keeps P <= I/delta without excitation: no covariance wind-up, and theta stays
/// where it was [Gunnarsson 1996, Combining tracking and regularization in recursive least squares
/// identification]. R is symmetric by construction, and lambda = 1 is plain least squares.
///
/// The adaptive law of lambda is the unity zone of [Park, Jun & Kim 1991, Fast tracking RLS
/// algorithm using novel variable forgetting factor with unity zone]
///
///     lambda = lambda_min + (1 - lambda_min) 2^(-round(rho e2)),   rho = 1 / (2 c sigma^2)
///
/// e2 is the mean squared prediction error over the error window, each divided by 1 + phi'P phi, so
/// that initial uncertainty is not mistaken for a change. c sigma^2 is what e2 reaches by noise
/// once in a million samples, counted in independent ones (`correlated_samples`), and at least
/// 19/2 sigma^2; below it lambda is exactly 1. lambda_min is `min_forgetting`, or less where the
/// memory is longer than the 1 / (1 - min_forgetting) samples that it keeps: one clear change
/// shortens it to those at once. With `min_forgetting` alone, hundreds of samples from before the
/// change would outweigh the few from after it.
///
/// `averaged` is dynamic model averaging [Raftery, Karny & Ettler 2010, Online prediction under
/// model uncertainty via dynamic model averaging]: five estimators run side by side, one with the
/// unity zone (`adaptive`), one over a block of `window` samples, and three with constant factors,
/// weighted by
///
///     log w_i <- alpha log w_i - q e_i^2 / (2 c s^2)
///
/// with s^2 the smallest of their squared errors, averaged, c the correlated samples and q the
/// sharpness: with 1, estimators that are a little worse keep so much weight that a drift is
/// followed less well than by the best of them. The unity zone alone takes a slow drift of the
/// parameters for noise; constant factors alone are either noisy or late. e_i is the error of
/// parameters that are one filter width old: a short memory predicts the correlated noise of a
/// filtered signal itself, and would always seem best. Its estimates are the weighted means;
/// variances include the differences between the memories; excitation and samples are those of the
/// memory with the largest weight, and `forgetting` of a step is the weighted mean.
///
/// Units: the caller's. Threads: one writer. step() neither allocates nor throws.
template <int N>
class ParameterEstimator {
  static_assert(N >= 1 && N <= 4);

 public:
  /// Throws ContractError for an option out of its range.
  explicit ParameterEstimator(const EstimatorOptions<N>& options = {},
                              const std::array<double, N>& initial = {});
  ParameterEstimator(ParameterEstimator&&) noexcept;
  ParameterEstimator& operator=(ParameterEstimator&&) noexcept;
  ~ParameterEstimator();

  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept;

  /// Solves for the stds and the excitation; costs more than a step.
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept;
  [[nodiscard]] std::array<double, N> parameters() const noexcept;

 private:
  std::unique_ptr<detail::Memory<N>> memory_;
};

extern template class ParameterEstimator<1>;
extern template class ParameterEstimator<2>;
extern template class ParameterEstimator<3>;
extern template class ParameterEstimator<4>;

}  // namespace pcavr
