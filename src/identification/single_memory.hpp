// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "pcavr/identification/estimator.hpp"

namespace pcavr::detail {

/// An estimator with one memory: block, exponential or adaptive. See ParameterEstimator.
template <int N>
class SingleMemory {
 public:
  SingleMemory(const EstimatorOptions<N>& options, const std::array<double, N>& initial);
  SingleMemory(SingleMemory&&) noexcept;
  SingleMemory& operator=(SingleMemory&&) noexcept;
  ~SingleMemory();

  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept;
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept;
  [[nodiscard]] std::array<double, N> parameters() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

extern template class SingleMemory<1>;
extern template class SingleMemory<2>;
extern template class SingleMemory<3>;
extern template class SingleMemory<4>;

}  // namespace pcavr::detail
