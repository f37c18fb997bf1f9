// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "quartic.hpp"

namespace pcavr::detail {
namespace {

/// x^n for n = -2..4 with 0 in place of negative powers: their factors vanish anyway.
struct Powers {
  std::array<double, 7> values{};

  explicit Powers(double x) noexcept {
    values[2] = 1.0;
    for (std::size_t n = 3; n < values.size(); ++n) values[n] = values[n - 1] * x;
  }
  [[nodiscard]] double operator()(int n) const noexcept {
    return values[static_cast<std::size_t>(n + 2)];
  }
};

}  // namespace

QuarticValue evaluate_quartic(const std::array<double, 15>& coefficients,
                              const Eigen::Vector3d& u) noexcept {
  const Powers x(u.x());
  const Powers y(u.y());
  const Powers z(u.z());
  QuarticValue q;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const double c = coefficients[i];
    const auto [a, b, d] = kQuarticExponents[i];
    q.value += c * x(a) * y(b) * z(d);
    q.gradient.x() += c * a * x(a - 1) * y(b) * z(d);
    q.gradient.y() += c * b * x(a) * y(b - 1) * z(d);
    q.gradient.z() += c * d * x(a) * y(b) * z(d - 1);
    q.hessian(0, 0) += c * a * (a - 1) * x(a - 2) * y(b) * z(d);
    q.hessian(1, 1) += c * b * (b - 1) * x(a) * y(b - 2) * z(d);
    q.hessian(2, 2) += c * d * (d - 1) * x(a) * y(b) * z(d - 2);
    q.hessian(0, 1) += c * a * b * x(a - 1) * y(b - 1) * z(d);
    q.hessian(0, 2) += c * a * d * x(a - 1) * y(b) * z(d - 1);
    q.hessian(1, 2) += c * b * d * x(a) * y(b - 1) * z(d - 1);
  }
  q.hessian(1, 0) = q.hessian(0, 1);
  q.hessian(2, 0) = q.hessian(0, 2);
  q.hessian(2, 1) = q.hessian(1, 2);
  return q;
}

std::array<double, 15> fourth_power_of(const Eigen::Vector3d& l) noexcept {
  constexpr double kFactorial[] = {1.0, 1.0, 2.0, 6.0, 24.0};
  const Powers x(l.x());
  const Powers y(l.y());
  const Powers z(l.z());
  std::array<double, 15> coefficients;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const auto [a, b, d] = kQuarticExponents[i];
    coefficients[i] = 24.0 / (kFactorial[a] * kFactorial[b] * kFactorial[d]) * x(a) * y(b) * z(d);
  }
  return coefficients;
}

}  // namespace pcavr::detail
