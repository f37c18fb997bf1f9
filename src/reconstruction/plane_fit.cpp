// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/plane_fit.hpp"

#include <cmath>

namespace pcavr {
namespace {

// Taps every kStep pixels to kReach on each side: sensor noise is correlated over more than a
// pixel, so that the ones between would add little.
constexpr int kStep = 2;
constexpr int kReach = 4;

struct Moments {
  float n = 0.0F, u = 0.0F, v = 0.0F, uu = 0.0F, uv = 0.0F, vv = 0.0F;
  float q = 0.0F, uq = 0.0F, vq = 0.0F;
};

InversePlane solve(const Moments& m, float centre) {
  // Cramer's rule on the normal equations of q = q0 + su u + sv v.
  const float c00 = m.uu * m.vv - m.uv * m.uv;
  const float c01 = m.uv * m.v - m.u * m.vv;
  const float c02 = m.u * m.uv - m.uu * m.v;
  const float determinant = m.n * c00 + m.u * c01 + m.v * c02;
  // Fewer than six taps, or all in a line: no plane to be had.
  if (m.n < 6.0F || determinant < 1.0F) return {centre, 0.0F, 0.0F};
  const float c11 = m.n * m.vv - m.v * m.v;
  const float c12 = m.u * m.v - m.n * m.uv;
  const float c22 = m.n * m.uu - m.u * m.u;
  const float scale = 1.0F / determinant;
  return {centre + (c00 * m.q + c01 * m.uq + c02 * m.vq) * scale,
          (c01 * m.q + c11 * m.uq + c12 * m.vq) * scale,
          (c02 * m.q + c12 * m.uq + c22 * m.vq) * scale};
}

}  // namespace

InversePlaneFitter::InversePlaneFitter(const DepthImage& depth, const DepthNoise& noise,
                                       const CameraModel& camera)
    : width_(depth.width()), stride_(depth.width() + 2 * kReach) {
  const auto size = static_cast<std::size_t>(stride_ * (depth.height() + 2 * kReach));
  inverse_.assign(size, 0.0F);
  tolerance_.assign(size, 0.0F);
  // Pixels of one surface differ by noise (3 sigma of a difference) and by the slope: that of a
  // surface at 70 deg over the reach of the window.
  const auto slope = static_cast<float>(std::tan(70.0 * 3.14159265 / 180.0) * kReach / camera.fx);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < width_; ++u) {
      const float z = depth(u, v);
      if (z <= 0.0F) continue;
      const auto i = static_cast<std::size_t>((v + kReach) * stride_ + u + kReach);
      inverse_[i] = 1.0F / z;
      const float sigma = static_cast<float>(noise.sigma(z)) / (z * z);
      tolerance_[i] = 4.24F * sigma + slope / z;
    }
  }
}

void InversePlaneFitter::fit_row(int v, std::span<InversePlane> planes) const {
  for (int u = 0; u < width_; ++u) {
    const auto i = static_cast<std::size_t>((v + kReach) * stride_ + u + kReach);
    const float centre = inverse_[i];
    if (centre <= 0.0F) continue;
    const float tolerance = tolerance_[i];
    Moments m;
    for (int dv = -kReach; dv <= kReach; dv += kStep) {
      for (int du = -kReach; du <= kReach; du += kStep) {
        const float q =
            inverse_[static_cast<std::size_t>((v + kReach + dv) * stride_ + u + kReach + du)] -
            centre;
        if (std::abs(q) > tolerance) continue;
        const auto x = static_cast<float>(du);
        const auto y = static_cast<float>(dv);
        m.n += 1.0F;
        m.u += x;
        m.v += y;
        m.uu += x * x;
        m.uv += x * y;
        m.vv += y * y;
        m.q += q;
        m.uq += x * q;
        m.vq += y * q;
      }
    }
    planes[static_cast<std::size_t>(u)] = solve(m, centre);
  }
}

}  // namespace pcavr
