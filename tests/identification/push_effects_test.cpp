// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/push_effects.hpp"

#include <cmath>
#include <cstdlib>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr::detail {
namespace {

constexpr int kPerPush = 3;
constexpr double kSampleStd = 0.2;

/// Random rows and values of some pushes: their sums, and themselves.
struct Samples {
  Eigen::MatrixXd rows;
  Eigen::VectorXd values;
  std::vector<PushSums<2>> pushes;
  NormalEquations<2> equations;

  explicit Samples(int count)
      : rows(kPerPush * count, 2),
        values(kPerPush * count),
        pushes(static_cast<std::size_t>(count)) {
    Random random(5);
    for (int i = 0; i < kPerPush * count; ++i) {
      rows.row(i) << 1.0, random.normal();
      values[i] = random.normal();
      const double weight = 1.0 / (kSampleStd * kSampleStd);
      const Eigen::Vector2d row = rows.row(i);
      equations.information += weight * row * row.transpose();
      equations.weighted += weight * values[i] * row;
      equations.misfit += weight * values[i] * values[i];
      equations.log_determinant -= std::log(weight);
      PushSums<2>& push = pushes[static_cast<std::size_t>(i / kPerPush)];
      push.weight += weight;
      push.row += weight * row;
      push.value += weight * values[i];
    }
  }
};

/// The same by the covariance of all values.
NormalEquations<2> dense_equations(const Samples& samples, const PushScatter& scatter) {
  const Eigen::Index count = samples.values.size();
  Eigen::MatrixXd covariance(count, count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      const int apart = std::abs(i / kPerPush - k / kPerPush);
      covariance(i, k) = scatter.std * scatter.std * std::pow(scatter.correlation, apart);
      if (apart == 0) covariance(i, k) += scatter.bias_std * scatter.bias_std;
      if (i == k) covariance(i, k) += kSampleStd * kSampleStd;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  NormalEquations<2> equations;
  equations.information = samples.rows.transpose() * factor.solve(samples.rows);
  equations.weighted = samples.rows.transpose() * factor.solve(samples.values);
  equations.misfit = samples.values.dot(factor.solve(samples.values));
  const Eigen::MatrixXd lower = factor.matrixL();
  equations.log_determinant = 2.0 * lower.diagonal().array().log().sum();
  return equations;
}

TEST(PushEffects, AreMarginalisedAsByTheCovarianceOfAllSamples) {
  for (const PushScatter& scatter :
       {PushScatter{0.1, 0.3, 0.0}, PushScatter{0.0, 0.5, 0.7}, PushScatter{0.2, 0.4, 0.95}}) {
    for (const int count : {1, 2, 5}) {
      const Samples samples(count);
      NormalEquations<2> found = samples.equations;
      marginalise_pushes(samples.pushes, scatter, found);
      const NormalEquations<2> expected = dense_equations(samples, scatter);
      EXPECT_TRUE(found.information.isApprox(expected.information, 1e-9)) << count;
      EXPECT_TRUE(found.weighted.isApprox(expected.weighted, 1e-9)) << count;
      EXPECT_NEAR(found.misfit, expected.misfit, 1e-9 * expected.misfit) << count;
      EXPECT_NEAR(found.log_determinant, expected.log_determinant, 1e-9) << count;
    }
  }
}

TEST(PlaceFilter, WhitensAsTheCovarianceOfAllSamplesDoes) {
  constexpr int kCount = 12;
  constexpr double kPlaceStd = 0.5;
  Random random(8);
  Eigen::MatrixXd columns(kCount, 4), covariance = Eigen::MatrixXd::Zero(kCount, kCount);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(kCount, kCount);
  std::vector<double> places;
  std::vector<NoiseCovariance> values;
  for (int i = 0; i < kCount; ++i) {
    columns.row(i) << random.normal(), random.normal(), random.normal(), 1.0;
    places.push_back((i == 0 ? 0.0 : places.back()) + random.uniform(0.1, 1.0));
    // The stds differ, with a correlation of up to a third, negative or positive.
    const double variance = random.uniform(0.1, 0.5);
    const double both = i == 0 ? 0.0 : std::sqrt(variance * values.back().own);
    values.push_back({variance, random.uniform(-0.33, 0.33) * both});
  }
  constexpr double kOwn = 0.3, kNext = -0.12;  // of a column's noise
  PlaceFilter<2> filter(kPlaceStd);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(4, 4);
  double log_determinant = 0.0, noise_product = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < kCount; ++j) {
      const double apart = std::abs(places[k] - places[static_cast<std::size_t>(j)]);
      covariance(i, j) = kPlaceStd * kPlaceStd * std::exp(-apart);
      noise(i, j) = i == j ? kOwn : std::abs(i - j) == 1 ? kNext : 0.0;
    }
    covariance(i, i) += values[k].own;
    if (i > 0) {
      covariance(i, i - 1) += values[k].next;
      covariance(i - 1, i) += values[k].next;
    }
    const double kept = i == 0 ? 0.0 : std::exp(places[k - 1] - places[k]);
    const NoiseCovariance column_noise{kOwn, i == 0 ? 0.0 : kNext};
    const auto whitened =
        filter.step(columns.row(i).transpose(), values[k], kept, {column_noise, {}});
    products += whitened.columns * whitened.columns.transpose();
    log_determinant += std::log(whitened.variance);
    noise_product += whitened.noise[0];
  }
  const Eigen::MatrixXd inverse = covariance.inverse();
  EXPECT_LT((products - columns.transpose() * inverse * columns).norm(), 1e-9 * products.norm());
  EXPECT_NEAR(log_determinant, std::log(covariance.determinant()), 1e-9);
  EXPECT_NEAR(noise_product, (inverse * noise).trace(), 1e-9);
}

}  // namespace
}  // namespace pcavr::detail
