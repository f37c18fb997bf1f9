// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "pcavr/physics/identification/estimator.hpp"

namespace pcavr::detail {

/// The memory that an estimator has of the samples: see ParameterEstimator for the methods and for
/// what each function gives.
template <int N>
class Memory {
 public:
  Memory() = default;
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  virtual ~Memory() = default;

  virtual EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept = 0;
  [[nodiscard]] virtual ParameterEstimate<N> estimate() const noexcept = 0;
  [[nodiscard]] virtual std::array<double, N> parameters() const noexcept = 0;
};

/// One memory: EstimationMethod::block, exponential or adaptive. `options` are valid.
template <int N>
[[nodiscard]] std::unique_ptr<Memory<N>> single_memory(const EstimatorOptions<N>& options,
                                                       const std::array<double, N>& initial);

/// Five of them, weighted: EstimationMethod::averaged. `options` are valid.
template <int N>
[[nodiscard]] std::unique_ptr<Memory<N>> averaged_memories(const EstimatorOptions<N>& options,
                                                           const std::array<double, N>& initial);

}  // namespace pcavr::detail
