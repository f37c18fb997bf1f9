// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/estimator.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"

#include "physics/identification/memory.hpp"

namespace pcavr {
namespace {

void check(const AveragingOptions& averaging) {
  for (const double factor :
       {averaging.medium_forgetting, averaging.fast_forgetting, averaging.fastest_forgetting}) {
    PCAVR_REQUIRE(factor > 0.0 && factor < 1.0, factor);
  }
  PCAVR_REQUIRE(averaging.weight_forgetting > 0.0 && averaging.weight_forgetting <= 1.0,
                averaging.weight_forgetting);
  PCAVR_REQUIRE(averaging.lag >= 0.0 && averaging.lag <= 100.0, averaging.lag);
  PCAVR_REQUIRE(averaging.sharpness > 0.0, averaging.sharpness);
}

template <int N>
void check(const EstimatorOptions<N>& options) {
  for (const double scale : options.scale) {
    PCAVR_REQUIRE(scale > 0.0 && std::isfinite(scale), scale);
  }
  PCAVR_REQUIRE(options.window >= N + 1, options.window);
  PCAVR_REQUIRE(options.forgetting > 0.0 && options.forgetting <= 1.0, options.forgetting);
  PCAVR_REQUIRE(options.min_forgetting > 0.0 && options.min_forgetting < 1.0,
                options.min_forgetting);
  PCAVR_REQUIRE(options.error_window >= 1, options.error_window);
  PCAVR_REQUIRE(options.prior_information > 0.0, options.prior_information);
  PCAVR_REQUIRE(options.correlated_samples >= 1.0, options.correlated_samples);
  PCAVR_REQUIRE(!options.noise_std || *options.noise_std > 0.0);
  check(options.averaging);
}

}  // namespace

template <int N>
ParameterEstimator<N>::ParameterEstimator(const EstimatorOptions<N>& options,
                                          const std::array<double, N>& initial) {
  check(options);
  memory_ = options.method == EstimationMethod::averaged
                ? detail::averaged_memories<N>(options, initial)
                : detail::single_memory<N>(options, initial);
}

template <int N>
ParameterEstimator<N>::ParameterEstimator(ParameterEstimator&&) noexcept = default;
template <int N>
ParameterEstimator<N>& ParameterEstimator<N>::operator=(ParameterEstimator&&) noexcept = default;
template <int N>
ParameterEstimator<N>::~ParameterEstimator() = default;

template <int N>
EstimatorStep ParameterEstimator<N>::step(const std::array<double, N>& regressors,
                                          double measured) noexcept {
  return memory_->step(regressors, measured);
}

template <int N>
ParameterEstimate<N> ParameterEstimator<N>::estimate() const noexcept {
  return memory_->estimate();
}

template <int N>
std::array<double, N> ParameterEstimator<N>::parameters() const noexcept {
  return memory_->parameters();
}

template class ParameterEstimator<1>;
template class ParameterEstimator<2>;
template class ParameterEstimator<3>;
template class ParameterEstimator<4>;

}  // namespace pcavr
