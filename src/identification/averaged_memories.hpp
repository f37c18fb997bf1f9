// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "pcavr/identification/estimator.hpp"

namespace pcavr::detail {

/// EstimationMethod::averaged: see ParameterEstimator.
template <int N>
class AveragedMemories {
 public:
  AveragedMemories(const EstimatorOptions<N>& options, const std::array<double, N>& initial);
  AveragedMemories(AveragedMemories&&) noexcept;
  AveragedMemories& operator=(AveragedMemories&&) noexcept;
  ~AveragedMemories();

  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept;
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept;
  [[nodiscard]] std::array<double, N> parameters() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

extern template class AveragedMemories<1>;
extern template class AveragedMemories<2>;
extern template class AveragedMemories<3>;
extern template class AveragedMemories<4>;

}  // namespace pcavr::detail
