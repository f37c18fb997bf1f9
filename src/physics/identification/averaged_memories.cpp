// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <vector>

#include "physics/identification/memory.hpp"

namespace pcavr::detail {
namespace {

constexpr std::size_t kEstimators = 5;
// Samples that the errors' variance is averaged over, and those before which it is a plain mean.
constexpr double kVarianceMemory = 200.0;
constexpr double kFirstSamples = 100.0;
// Variances beyond which an error is a change, not noise.
constexpr double kClip = 9.0;
constexpr double kMinVariance = 1e-12;

template <int N>
double predict(const std::array<double, N>& regressors, const std::array<double, N>& parameters) {
  double sum = 0.0;
  for (std::size_t i = 0; i < N; ++i) sum += regressors[i] * parameters[i];
  return sum;
}

template <int N>
struct AveragedState {
  AveragedState(const EstimatorOptions<N>& options, const std::array<double, N>& initial)
      : alpha(options.averaging.weight_forgetting),
        sharpness(options.averaging.sharpness),
        correlated(options.correlated_samples) {
    const AveragingOptions& averaging = options.averaging;
    const double factors[] = {averaging.medium_forgetting, averaging.fast_forgetting,
                              averaging.fastest_forgetting};
    EstimatorOptions<N> one = options;
    one.method = EstimationMethod::adaptive;
    estimators.push_back(single_memory<N>(one, initial));
    one.method = EstimationMethod::exponential;
    for (const double factor : factors) {
      one.forgetting = factor;
      estimators.push_back(single_memory<N>(one, initial));
    }
    one.method = EstimationMethod::block;
    estimators.push_back(single_memory<N>(one, initial));
    const auto delay = static_cast<std::size_t>(std::lround(averaging.lag * correlated));
    earlier.assign(kEstimators,
                   std::vector<std::array<double, N>>(std::max<std::size_t>(1, delay), initial));
    weight.fill(1.0 / static_cast<double>(kEstimators));
  }

  void weigh(const std::array<double, kEstimators>& squared) {
    const double smallest = *std::min_element(squared.begin(), squared.end());
    samples += 1.0;
    const double clipped =
        samples < kFirstSamples ? smallest : std::min(smallest, kClip * variance);
    variance += (clipped - variance) / std::min(samples, kVarianceMemory);
    const double scale = 2.0 * correlated * std::max(variance, kMinVariance);
    for (std::size_t i = 0; i < kEstimators; ++i) {
      log_weight[i] = alpha * log_weight[i] - sharpness * squared[i] / scale;
    }
    const double largest = *std::max_element(log_weight.begin(), log_weight.end());
    double sum = 0.0;
    for (std::size_t i = 0; i < kEstimators; ++i) {
      weight[i] = std::exp(log_weight[i] - largest);
      sum += weight[i];
    }
    for (double& w : weight) w /= sum;
  }

  [[nodiscard]] std::size_t heaviest() const {
    return static_cast<std::size_t>(
        std::distance(weight.begin(), std::max_element(weight.begin(), weight.end())));
  }

  std::vector<std::unique_ptr<Memory<N>>> estimators;
  /// Ring of each estimator's parameters, from `lag` ago.
  std::vector<std::vector<std::array<double, N>>> earlier;
  std::size_t next = 0;
  std::array<double, kEstimators> log_weight{};
  std::array<double, kEstimators> weight{};
  double alpha = 1.0;
  double sharpness = 1.0;
  double correlated = 1.0;
  double variance = 0.0;
  double samples = 0.0;
};

template <int N>
class AveragedMemories final : public Memory<N> {
 public:
  AveragedMemories(const EstimatorOptions<N>& options, const std::array<double, N>& initial)
      : state_(options, initial) {}

  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept override;
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept override;
  [[nodiscard]] std::array<double, N> parameters() const noexcept override;

 private:
  AveragedState<N> state_;
};

template <int N>
EstimatorStep AveragedMemories<N>::step(const std::array<double, N>& regressors,
                                        double measured) noexcept {
  AveragedState<N>& state = state_;
  EstimatorStep mean{.forgetting = 0.0, .was_used = true};
  std::array<double, kEstimators> squared{};
  const std::size_t slot = state.next % state.earlier.front().size();
  for (std::size_t i = 0; i < kEstimators; ++i) {
    const EstimatorStep step = state.estimators[i]->step(regressors, measured);
    mean.was_used = mean.was_used && step.was_used;
    mean.prediction += state.weight[i] * step.prediction;
    mean.forgetting += state.weight[i] * step.forgetting;
    if (!step.was_used) continue;
    std::array<double, N>& earlier = state.earlier[i][slot];
    squared[i] = std::pow(measured - predict<N>(regressors, earlier), 2);
    earlier = state.estimators[i]->parameters();
  }
  mean.error = measured - mean.prediction;
  if (!mean.was_used) return mean;
  ++state.next;
  state.weigh(squared);
  return mean;
}

template <int N>
ParameterEstimate<N> AveragedMemories<N>::estimate() const noexcept {
  const AveragedState<N>& state = state_;
  std::array<ParameterEstimate<N>, kEstimators> each;
  for (std::size_t i = 0; i < kEstimators; ++i) each[i] = state.estimators[i]->estimate();
  ParameterEstimate<N> mean = each[state.heaviest()];
  mean.value = parameters();
  for (std::size_t k = 0; k < N; ++k) {
    double variance = 0.0;
    for (std::size_t i = 0; i < kEstimators; ++i) {
      if (state.weight[i] <= 0.0) continue;
      const double difference = each[i].value[k] - mean.value[k];
      variance += state.weight[i] * (each[i].std[k] * each[i].std[k] + difference * difference);
    }
    mean.std[k] = std::sqrt(variance);
  }
  return mean;
}

template <int N>
std::array<double, N> AveragedMemories<N>::parameters() const noexcept {
  std::array<double, N> mean{};
  for (std::size_t i = 0; i < kEstimators; ++i) {
    const std::array<double, N> one = state_.estimators[i]->parameters();
    for (std::size_t k = 0; k < N; ++k) mean[k] += state_.weight[i] * one[k];
  }
  return mean;
}

}  // namespace

template <int N>
std::unique_ptr<Memory<N>> averaged_memories(const EstimatorOptions<N>& options,
                                             const std::array<double, N>& initial) {
  return std::make_unique<AveragedMemories<N>>(options, initial);
}

template std::unique_ptr<Memory<1>> averaged_memories<1>(const EstimatorOptions<1>&,
                                                         const std::array<double, 1>&);
template std::unique_ptr<Memory<2>> averaged_memories<2>(const EstimatorOptions<2>&,
                                                         const std::array<double, 2>&);
template std::unique_ptr<Memory<3>> averaged_memories<3>(const EstimatorOptions<3>&,
                                                         const std::array<double, 3>&);
template std::unique_ptr<Memory<4>> averaged_memories<4>(const EstimatorOptions<4>&,
                                                         const std::array<double, 4>&);

}  // namespace pcavr::detail
