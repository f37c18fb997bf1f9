// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Least-squares planes in inverse depth around pixels, a SIMD vector of pixels at a time. In
// inverse depth (disparity) stereo and structured light have uniform noise and quantisation.
#include "perception/reconstruction/kernels.hpp"
#include "perception/reconstruction/noise_table_sizes.hpp"
#include "perception/reconstruction/simd_records.hpp"

namespace pcavr {
namespace {

struct Moments {
  Floats n = {}, u = {}, v = {}, uu = {}, uv = {}, vv = {};
  Floats q = {}, uq = {}, vq = {};  ///< q: inverse depth minus the centre's
};

/// Moments over the pixels of the window that belong to the centre's surface.
inline Moments window_moments(const float* centre_at, int stride, Floats centre, Floats tolerance) {
  Moments m;
  for (int dv = -kPlaneWindowRadius; dv <= kPlaneWindowRadius; ++dv) {
    Floats n = {}, u = {}, uu = {}, q = {}, uq = {};
    for (int du = -kPlaneWindowRadius; du <= kPlaneWindowRadius; ++du) {
      const auto x = static_cast<float>(du);
      const Floats difference = load(centre_at + dv * stride + du) - centre;
      const Ints is_same = (difference <= tolerance) & (difference >= -tolerance);
      const Floats one = masked(is_same, splat(1.0F));
      const Floats value = masked(is_same, difference);
      n += one;
      u += one * x;
      uu += one * (x * x);
      q += value;
      uq += value * x;
    }
    const auto y = static_cast<float>(dv);
    m.n += n;
    m.u += u;
    m.uu += uu;
    m.v += n * y;
    m.uv += u * y;
    m.vv += n * (y * y);
    m.q += q;
    m.uq += uq;
    m.vq += q * y;
  }
  return m;
}

/// 1 / z = inverse + slope_u (u - u0) + slope_v (v - v0).
struct InversePlanes {
  Floats inverse, slope_u, slope_v;
};

/// Cramer's rule on the normal equations. Constant where the fit is degenerate: fewer than six
/// pixels, or collinear ones.
inline InversePlanes solve(const Moments& m, Floats centre) {
  const Floats c00 = m.uu * m.vv - m.uv * m.uv;
  const Floats c01 = m.uv * m.v - m.u * m.vv;
  const Floats c02 = m.u * m.uv - m.uu * m.v;
  const Floats determinant = m.n * c00 + m.u * c01 + m.v * c02;
  const Floats c11 = m.n * m.vv - m.v * m.v;
  const Floats c12 = m.u * m.v - m.n * m.uv;
  const Floats c22 = m.n * m.uu - m.u * m.u;
  const Ints is_well_determined = (m.n >= 6.0F) & (determinant >= 1.0F);
  const Floats scale = 1.0F / select(is_well_determined, determinant, splat(1.0F));
  return {centre + masked(is_well_determined, (c00 * m.q + c01 * m.uq + c02 * m.vq) * scale),
          masked(is_well_determined, (c01 * m.q + c11 * m.uq + c12 * m.vq) * scale),
          masked(is_well_determined, (c02 * m.q + c12 * m.uq + c22 * m.vq) * scale)};
}

/// The members of kLanes PixelSurfaces, from pixel u.
inline RecordLanes find_lanes(const PixelRow& row, int u, Floats free_depth, Floats color) {
  const float* at = row.inverse + u;
  const Floats inverse = load(at);
  const Ints has_depth = inverse > 0.0F;
  const Floats depth = 1.0F / select(has_depth, inverse, splat(1.0F));
  const Floats position = (depth - row.min_depth) * row.steps_per_metre;
  const Ints step =
      to_ints(lane_min(lane_max(position, Floats{}), splat(static_cast<float>(row.last_step))));
  const Floats tolerance = gather(row.inverse_tolerances, step) + inverse * row.slope_tolerance;
  const InversePlanes plane =
      solve(window_moments(at, row.inverse_stride, inverse, tolerance), inverse);

  // The plane is a X + b Y + c Z = 1.
  const Floats x = row.ray_x + to_floats((Ints)lane_numbers() + u) * row.ray_step;
  const Floats a = plane.slope_u * row.fx;
  const Floats b = plane.slope_v * row.fy;
  const Floats c = plane.inverse - a * x - b * row.ray_y;
  const Floats offset = 1.0F / square_root(a * a + b * b + c * c);
  const Floats cosine =
      offset * plane.inverse / square_root(x * x + (row.ray_y * row.ray_y + 1.0F));
  const Floats cosine_step =
      lane_min(lane_max(cosine, Floats{}), splat(1.0F)) * (kNoiseCosines - 1) + 0.5F;
  const Ints entry = step / kNoiseDepthsPerWeight * kNoiseCosines + to_ints(cosine_step);

  return {{a * offset, b * offset, c * offset, select(has_depth, offset, splat(-1e9F)),
           gather(row.weights, entry), gather(row.truncations, step), free_depth, color}};
}

void find_surfaces(const PixelRow& row, PixelSurface* pixels) {
  const auto* colors = reinterpret_cast<const float*>(row.color);  // copied only, no arithmetic
  int u = 0;
  for (; u + kLanes <= row.width; u += kLanes) {
    store_records(find_lanes(row, u, load(row.free_depth + u), load(colors + u)), pixels[u].normal);
  }
  if (u == row.width) return;
  const int count = row.width - u;
  PixelSurface last[kLanes];
  store_records(
      find_lanes(row, u, load_some(row.free_depth + u, count), load_some(colors + u, count)),
      last[0].normal);
  for (int i = 0; i < count; ++i) pixels[u + i] = last[i];
}

}  // namespace
}  // namespace pcavr
