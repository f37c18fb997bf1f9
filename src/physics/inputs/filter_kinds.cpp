// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/filter_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace pcavr {
namespace {

constexpr std::size_t kMaxAverage = 120;  // [samples] an eighth of a second at 1 kHz
constexpr double kAverageCorrelation = -0.5;
constexpr double kMaxAverageError = 0.2;  // of this correlation, and of the others from 0
/// Samples of the runs over those of the average: the ends of runs have no partner.
constexpr std::size_t kMinWindows = 3;

constexpr std::size_t kMaxButterworth = 4;                   // order
constexpr double kMinCutoff = 1.0 / 300, kMaxCutoff = 0.25;  // [1/samples]
constexpr int kCutoffs = 80;                                 // steps of 6 %
constexpr int kCutoffRefinements = 30;                       // of a golden section
constexpr std::size_t kCorrelationLags = 8;
/// Correlations of correlated noise vary more than those of white noise [Bartlett 1946].
constexpr double kCorrelatedFactor = 1.5;

constexpr double kMemory = 1.0;  // [s] of what a moving average has left of its window
/// A zero inside the unit circle in place of one on it: 0 would leave the noise correlated over the
/// order's samples, 0.9 would amplify the digits' rounding by 19 for each order.
constexpr double kZero = 0.6;

/// Sums of products of the values `a` and `b` [samples] ago, over the same samples: exact for every
/// filter of up to kMaxButterworth poles.
using Products = Eigen::Matrix<double, kMaxButterworth + kCorrelationLags + 1,
                               kMaxButterworth + kCorrelationLags + 1>;

Products products_of(const FreeRuns& runs) {
  constexpr Eigen::Index kRows = Products::RowsAtCompileTime;
  Products sums = Products::Zero();
  for (const std::vector<double>& run : runs) {
    for (std::size_t i = kRows; i <= run.size(); ++i) {
      // The newest sample is the last.
      const Eigen::Map<const Eigen::Matrix<double, kRows, 1>> window(&run[i - kRows]);
      sums.selfadjointView<Eigen::Lower>().rankUpdate(window);
    }
  }
  return sums.selfadjointView<Eigen::Lower>();
}

/// 1, -a_1, -a_2, ...
Eigen::VectorXd inverse_of(const Butterworth& filter) {
  const std::vector<double> coefficients = filter.coefficients();
  Eigen::VectorXd inverse(static_cast<Eigen::Index>(filter.order) + 1);
  inverse[0] = 1.0;
  for (std::size_t i = 0; i < filter.order; ++i) {
    inverse[static_cast<Eigen::Index>(i) + 1] = -coefficients[i];
  }
  return inverse;
}

/// Of white noise behind (1 + z^-1)^order, at lags 1 to kCorrelationLags.
std::vector<double> correlations_of_zeros(std::size_t order) {
  std::vector<double> binomial{1.0};
  for (std::size_t k = 0; k < order; ++k) {
    binomial.push_back(0.0);
    for (std::size_t i = binomial.size() - 1; i > 0; --i) binomial[i] += binomial[i - 1];
  }
  const auto product = [&](std::size_t lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < binomial.size(); ++i) sum += binomial[i] * binomial[i - lag];
    return sum;
  };
  std::vector<double> correlations;
  for (std::size_t lag = 1; lag <= kCorrelationLags; ++lag) {
    correlations.push_back(product(lag) / product(0));
  }
  return correlations;
}

/// Squares of what the correlations behind the poles' inverse differ from those of the zeros.
double misfit(const Butterworth& filter, const std::vector<Products>& axes) {
  constexpr Eigen::Index kLast = Products::RowsAtCompileTime - 1;
  const Eigen::VectorXd inverse = inverse_of(filter).reverse();
  const std::vector<double> expected = correlations_of_zeros(filter.order);
  const Eigen::Index size = inverse.size();
  double squares = 0.0;
  for (const Products& axis : axes) {
    const auto product = [&](Eigen::Index lag) {
      const Eigen::Index first = kLast + 1 - size;
      return inverse.dot(axis.block(first, first - lag, size, size) * inverse);
    };
    const double variance = product(0);
    if (!(variance > 0.0)) return std::numeric_limits<double>::infinity();
    for (std::size_t lag = 1; lag <= kCorrelationLags; ++lag) {
      const double found = product(static_cast<Eigen::Index>(lag)) / variance;
      squares += (found - expected[lag - 1]) * (found - expected[lag - 1]);
    }
  }
  return squares;
}

/// By steps, then by a golden section between the best one's neighbours.
Butterworth fit_cutoff(std::size_t order, const std::vector<Products>& axes) {
  const double step = std::log(kMaxCutoff / kMinCutoff) / kCutoffs;
  const auto at = [&](double k) { return Butterworth{order, kMinCutoff * std::exp(step * k)}; };
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= kCutoffs; ++k) {
    const double found = misfit(at(k), axes);
    if (found < least) least = found, best = k;
  }
  double low = best - 1.0, high = best + 1.0;
  const double share = 1.0 / std::numbers::phi;
  for (int i = 0; i < kCutoffRefinements; ++i) {
    const double a = high - share * (high - low), b = low + share * (high - low);
    if (misfit(at(a), axes) < misfit(at(b), axes)) {
      high = b;
    } else {
      low = a;
    }
  }
  return at(0.5 * (low + high));
}

bool explains(const Butterworth& filter, const FreeRuns& runs) {
  const std::vector<double> expected = correlations_of_zeros(filter.order);
  const std::vector<double> found =
      correlations_of(innovations(runs, filter.coefficients()), kCorrelationLags);
  if (found.size() != expected.size()) return false;
  const double limit = kCorrelatedFactor * correlation_limit(runs);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (std::abs(found[k] - expected[k]) > limit) return false;
  }
  return true;
}

FreeRuns differences_of(const FreeRuns& runs, std::size_t& longest) {
  FreeRuns differences;
  for (const std::vector<double>& run : runs) {
    std::vector<double>& steps = differences.emplace_back();
    for (std::size_t i = 1; i < run.size(); ++i) steps.push_back(run[i] - run[i - 1]);
    longest = std::max(longest, steps.size());
  }
  return differences;
}

/// Between the samples where `at` is no whole number.
Eigen::Vector3d value_at(std::span<const Eigen::Vector3d> values, double at) {
  const auto last = static_cast<double>(values.size() - 1);
  const double clamped = std::clamp(at, 0.0, last);
  const auto before = static_cast<std::size_t>(clamped);
  const std::size_t after = std::min(before + 1, values.size() - 1);
  const double share = clamped - static_cast<double>(before);
  return (1.0 - share) * values[before] + share * values[after];
}

}  // namespace

std::optional<std::size_t> find_moving_average(const std::vector<FreeRuns>& axes) {
  std::optional<std::size_t> common;
  for (const FreeRuns& runs : axes) {
    std::size_t longest = 0;
    const FreeRuns steps = differences_of(runs, longest);
    const std::vector<double> correlations =
        correlations_of(steps, std::min(kMaxAverage, longest / kMinWindows));
    if (correlations.empty()) return std::nullopt;
    const auto least = std::min_element(correlations.begin(), correlations.end());
    const auto samples = static_cast<std::size_t>(least - correlations.begin()) + 1;
    if (samples == 1 || (common && *common != samples)) return std::nullopt;
    for (auto at = correlations.begin(); at != correlations.end(); ++at) {
      const double expected = at == least ? kAverageCorrelation : 0.0;
      if (std::abs(*at - expected) > kMaxAverageError) return std::nullopt;
    }
    common = samples;
  }
  return common;
}

std::vector<double> Butterworth::coefficients() const {
  // Each section (1 - K) / (1 + K), or of two poles, by K = tan(pi cutoff).
  const double k = std::tan(std::numbers::pi * cutoff);
  std::vector<double> inverse{1.0};
  const auto multiply = [&inverse](double first, double second) {
    std::vector<double> product(inverse.size() + (second == 0.0 ? 1 : 2), 0.0);
    for (std::size_t i = 0; i < inverse.size(); ++i) {
      product[i] += inverse[i];
      product[i + 1] += first * inverse[i];
      if (second != 0.0) product[i + 2] += second * inverse[i];
    }
    inverse = product;
  };
  if (order % 2 == 1) multiply(-(1.0 - k) / (1.0 + k), 0.0);
  for (std::size_t pair = 0; pair < order / 2; ++pair) {
    const double odd = order % 2 == 0 ? 2.0 * static_cast<double>(pair) + 1.0
                                      : 2.0 * static_cast<double>(pair) + 2.0;
    const double damping =
        2.0 * std::cos(0.5 * std::numbers::pi * odd / static_cast<double>(order));
    const double scale = 1.0 + damping * k + k * k;
    multiply(2.0 * (k * k - 1.0) / scale, (1.0 - damping * k + k * k) / scale);
  }
  std::vector<double> result;
  for (std::size_t i = 1; i < inverse.size(); ++i) result.push_back(-inverse[i]);
  return result;
}

double Butterworth::delay() const {
  const std::vector<double> a = coefficients();
  const double gain = 1.0 - std::accumulate(a.begin(), a.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(i + 1) * a[i];
  return sum / gain + 0.5 * static_cast<double>(order);
}

std::optional<Butterworth> find_butterworth(const std::vector<FreeRuns>& axes) {
  std::vector<Products> products;
  for (const FreeRuns& runs : axes) products.push_back(products_of(runs));
  std::optional<Butterworth> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t order = 1; order <= kMaxButterworth; ++order) {
    const Butterworth filter = fit_cutoff(order, products);
    const double found = misfit(filter, products);
    if (found < least) least = found, best = filter;
  }
  if (!best) return std::nullopt;
  const bool is_it =
      std::ranges::all_of(axes, [&](const FreeRuns& runs) { return explains(*best, runs); });
  return is_it ? best : std::nullopt;
}

std::vector<Eigen::Vector3d> before_average(std::size_t samples, double interval,
                                            std::span<const Eigen::Vector3d> values) {
  const auto n = static_cast<double>(samples);
  const double kept = std::exp(-n * interval / kMemory);
  // About the average at its middle, which has no delay.
  std::vector<Eigen::Vector3d> middle, result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    middle.push_back(value_at(values, static_cast<double>(i) + 0.5 * (n - 1.0)));
  }
  std::vector<Eigen::Vector3d> rest(values.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = samples; i < values.size(); ++i) {
    rest[i] = kept * rest[i - samples] + n * (values[i] - values[i - 1]) -
              (middle[i] - middle[i - samples]);
  }
  for (std::size_t i = 0; i < values.size(); ++i) result.push_back(middle[i] + rest[i]);
  return result;
}

std::vector<Eigen::Vector3d> before_recursion(const std::vector<double>& coefficients,
                                              std::span<const Eigen::Vector3d> values) {
  const double scale = 1.0 / (1.0 - std::accumulate(coefficients.begin(), coefficients.end(), 0.0));
  std::vector<Eigen::Vector3d> result(values.begin(), values.end());
  for (std::size_t i = coefficients.size(); i < values.size(); ++i) {
    Eigen::Vector3d value = values[i];
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
      value -= coefficients[k] * values[i - 1 - k];
    }
    result[i] = scale * value;
  }
  return result;
}

std::vector<Eigen::Vector3d> before_butterworth(const Butterworth& filter,
                                                std::span<const Eigen::Vector3d> values) {
  std::vector<Eigen::Vector3d> result = before_recursion(filter.coefficients(), values);
  for (std::size_t zero = 0; zero < filter.order; ++zero) {
    for (std::size_t i = 1; i < result.size(); ++i) {
      result[i] = (1.0 + kZero) * result[i] - kZero * result[i - 1];
    }
  }
  return result;
}

}  // namespace pcavr
