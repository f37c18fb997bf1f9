// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "physics/identification/memory.hpp"
#include "physics/identification/small_solve.hpp"

namespace pcavr::detail {
namespace {

// Larger regressors, relative to their stated scale, would lose the rest in rounding.
constexpr double kMaxScaled = 1e9;
// Unity zone: a mean squared error of this many variances rounds to the first step below lambda
// = 1.
constexpr double kUnityZone = 9.5;
// Standard normal deviate that one sample in a million exceeds.
constexpr double kOneInAMillion = 4.753;
// Share of a regressor's energy that the others must leave unexplained; below, the parameters are
// collinear within rounding and noise.
constexpr double kMinOwnShare = 1e-4;
// Samples that the estimated noise is averaged over.
constexpr double kNoiseMemory = 1000.0;
// Independent samples beyond the parameters that the first noise estimate needs.
constexpr double kNoiseFreedom = 5.0;

/// The mean squared error, in variances, that noise reaches once in a million samples: of chi
/// squared, after [Wilson & Hilferty 1931], with as many degrees of freedom as the window has
/// independent samples. For white noise that is less than the unity zone, which then applies.
double quiet_level(double window, double correlated_samples) {
  const double spread = 2.0 / (9.0 * std::max(1.0, window / correlated_samples));
  const double cube_root = 1.0 - spread + kOneInAMillion * std::sqrt(spread);
  return std::max(kUnityZone, cube_root * cube_root * cube_root);
}

template <int N>
struct SingleState {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  SingleState(const EstimatorOptions<N>& given, const std::array<double, N>& initial)
      : options(given), information(Matrix::Identity() * given.prior_information) {
    for (int i = 0; i < N; ++i) {
      scale[i] = given.scale[static_cast<std::size_t>(i)];
      theta[i] = initial[static_cast<std::size_t>(i)] * scale[i];
      inverse_scale[i] = 1.0 / scale[i];
    }
    errors.assign(static_cast<std::size_t>(given.error_window), 0.0);
    quiet = quiet_level(given.error_window, given.correlated_samples);
    min_memory = 1.0 / (1.0 - given.min_forgetting);
    if (given.method == EstimationMethod::block) {
      block.resize(static_cast<std::size_t>(given.window));
    }
    noise_variance = given.noise_std ? *given.noise_std * *given.noise_std : 0.0;
  }

  struct Row {
    Vector phi = Vector::Zero();
    double measured = 0.0;
  };

  void step_block(const Vector& phi, double measured) {
    block[next_row] = {phi, measured};
    next_row = (next_row + 1) % block.size();
    rows = std::min(rows + 1, block.size());
    information = Matrix::Identity() * options.prior_information;
    Vector rhs = Vector::Zero();
    for (std::size_t i = 0; i < rows; ++i) {
      information.noalias() += block[i].phi * block[i].phi.transpose();
      rhs += block[i].phi * (block[i].measured - block[i].phi.dot(theta));
    }
    theta += solve_positive<N>(information, rhs);
    samples = static_cast<double>(rows);
  }

  void step_recursive(const Vector& phi, double error, double lambda) {
    information *= lambda;
    information.diagonal().array() += (1.0 - lambda) * options.prior_information;
    information.noalias() += phi * phi.transpose();
    const Vector gain = solve_positive<N>(information, phi);
    theta += gain * error;
    leverage = std::min(phi.dot(gain), 1.0);
    residual_sum = lambda * residual_sum + error * error * (1.0 - leverage);
    samples = lambda * samples + 1.0;
  }

  /// The law of lambda from the errors before this sample.
  [[nodiscard]] double forgetting() const {
    if (options.method == EstimationMethod::exponential) return options.forgetting;
    if (!is_settled() || noise_variance <= 0.0) return 1.0;
    const double mean = error_sum / static_cast<double>(errors.size());
    const double steps = std::round(mean / (2.0 * quiet * noise_variance));
    if (steps <= 0.0) return 1.0;
    // Samples from before a change are wrong: reset at once to the memory that lambda_min keeps.
    const double reset = min_memory / std::max(samples, min_memory);
    const double min_lambda = std::min(options.min_forgetting, reset);
    return min_lambda + (1.0 - min_lambda) * std::exp2(-steps);
  }

  /// Enough samples for meaningful errors: the parameters are overdetermined, and the window
  /// contains only their errors.
  [[nodiscard]] bool is_settled() const {
    const double freedom = options.noise_std ? 0.0 : kNoiseFreedom;
    return static_cast<double>(total_samples) >
           (N + freedom) * options.correlated_samples + static_cast<double>(errors.size());
  }

  void add_error(double error) {
    // phi'R^-1 phi with the new sample in R is L = q/(1+q), so 1/(1+q) is 1 - L.
    const double squared = error * error * (1.0 - leverage);
    error_sum += squared - errors[next_error];
    errors[next_error] = squared;
    next_error = (next_error + 1) % errors.size();
    if (next_error == 0) {  // recompute once per window: rounding errors do not accumulate
      error_sum = 0.0;
      for (const double e : errors) error_sum += e;
    }
    ++total_samples;
    if (!options.noise_std) update_noise(squared);
  }

  /// Each parameter uses up one independent sample (degrees of freedom).
  void update_noise(double squared) {
    if (!is_settled()) {
      noise_variance = residual_sum / std::max(samples - N * options.correlated_samples, 1.0);
      return;
    }
    const double change = std::min(squared, 9.0 * noise_variance) - noise_variance;
    noise_variance += change / std::min(static_cast<double>(total_samples), kNoiseMemory);
  }

  [[nodiscard]] double residual_variance() const {
    const double freedom = samples - N;
    if (freedom <= 0.0) return 0.0;
    if (options.method != EstimationMethod::block) return residual_sum / freedom;
    double sum = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double error = block[i].measured - block[i].phi.dot(theta);
      sum += error * error;
    }
    return sum / freedom;
  }

  EstimatorOptions<N> options;
  Matrix information;
  Vector theta = Vector::Zero();
  Vector scale = Vector::Ones();
  Vector inverse_scale = Vector::Ones();
  double samples = 0.0;
  double residual_sum = 0.0;
  double leverage = 0.0;
  double noise_variance = 0.0;
  double quiet = 0.0;       // mean squared error over the variance up to which lambda is 1
  double min_memory = 0.0;  // samples
  std::vector<double> errors;
  std::size_t next_error = 0;
  double error_sum = 0.0;
  std::size_t total_samples = 0;
  std::vector<Row> block;
  std::size_t next_row = 0;
  std::size_t rows = 0;
};

template <int N>
class SingleMemory final : public Memory<N> {
 public:
  SingleMemory(const EstimatorOptions<N>& options, const std::array<double, N>& initial)
      : state_(options, initial) {}

  EstimatorStep step(const std::array<double, N>& regressors, double measured) noexcept override;
  [[nodiscard]] ParameterEstimate<N> estimate() const noexcept override;
  [[nodiscard]] std::array<double, N> parameters() const noexcept override;

 private:
  SingleState<N> state_;
};

template <int N>
EstimatorStep SingleMemory<N>::step(const std::array<double, N>& regressors,
                                    double measured) noexcept {
  SingleState<N>& state = state_;
  typename SingleState<N>::Vector phi;
  bool is_valid = std::isfinite(measured);
  for (int i = 0; i < N; ++i) {
    phi[i] = regressors[static_cast<std::size_t>(i)] * state.inverse_scale[i];
    is_valid = is_valid && std::abs(phi[i]) < kMaxScaled;  // false for NaN, too
  }
  EstimatorStep step;
  step.prediction = phi.dot(state.theta);
  step.error = measured - step.prediction;
  if (!is_valid) return step;
  step.was_used = true;
  if (state.options.method == EstimationMethod::block) {
    state.step_block(phi, measured);
    return step;
  }
  step.forgetting = state.forgetting();
  state.step_recursive(phi, step.error, step.forgetting);
  state.add_error(step.error);
  return step;
}

template <int N>
ParameterEstimate<N> SingleMemory<N>::estimate() const noexcept {
  const SingleState<N>& state = state_;
  ParameterEstimate<N> result;
  result.value = parameters();
  result.samples = state.samples;
  result.residual_variance = state.residual_variance();
  const typename SingleState<N>::Matrix P = invert_positive<N>(state.information);
  for (int i = 0; i < N; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // 1 / P_ii is the energy of regressor i that the others leave unexplained.
    const double own = std::max(1.0 / P(i, i) - state.options.prior_information, 0.0);
    const double own_rms = std::sqrt(own / std::max(state.samples, 1.0)) * state.scale[i];
    const bool is_determined = state.samples > N + 0.5;
    result.is_excited[k] = is_determined && own > kMinOwnShare * state.information(i, i) &&
                           own > state.options.prior_information &&
                           own_rms >= state.options.min_excitation[k];
    result.std[k] =
        is_determined
            ? std::sqrt(result.residual_variance * P(i, i) * state.options.correlated_samples) *
                  state.inverse_scale[i]
            : std::numeric_limits<double>::infinity();
  }
  return result;
}

template <int N>
std::array<double, N> SingleMemory<N>::parameters() const noexcept {
  std::array<double, N> values{};
  for (int i = 0; i < N; ++i) {
    values[static_cast<std::size_t>(i)] = state_.theta[i] * state_.inverse_scale[i];
  }
  return values;
}

}  // namespace

template <int N>
std::unique_ptr<Memory<N>> single_memory(const EstimatorOptions<N>& options,
                                         const std::array<double, N>& initial) {
  return std::make_unique<SingleMemory<N>>(options, initial);
}

template std::unique_ptr<Memory<1>> single_memory<1>(const EstimatorOptions<1>&,
                                                     const std::array<double, 1>&);
template std::unique_ptr<Memory<2>> single_memory<2>(const EstimatorOptions<2>&,
                                                     const std::array<double, 2>&);
template std::unique_ptr<Memory<3>> single_memory<3>(const EstimatorOptions<3>&,
                                                     const std::array<double, 3>&);
template std::unique_ptr<Memory<4>> single_memory<4>(const EstimatorOptions<4>&,
                                                     const std::array<double, 4>&);

}  // namespace pcavr::detail
