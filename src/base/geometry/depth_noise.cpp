// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/depth_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr auto kDepthNoiseFields = std::to_array<OptionField<DepthNoise>>({
    {"constant", &DepthNoise::constant, 0.0012, 1e-6, 0.1, "m",
     "standard deviation of depth at the range of `offset`",
     "lower: noise is fused as surface and tracking is overconfident; higher: edges are blurred"},
    {"quadratic", &DepthNoise::quadratic, 0.0019, 0.0, 0.1, "1/m",
     "growth of the standard deviation with the square of the range",
     "lower: far depth gets too much weight; higher: it is almost ignored"},
    {"offset", &DepthNoise::offset, 0.4, -10.0, 10.0, "m", "range of the lowest noise",
     "lower: depth beyond it gets less weight; higher: near depth gets less weight"},
    {"grazing", &DepthNoise::grazing, 0.0001, 0.0, 0.01, "m^1.5",
     "growth of the standard deviation on surfaces that are seen obliquely",
     "lower: oblique surfaces get too much weight; higher: they are almost ignored"},
    {"min_depth", &DepthNoise::min_depth, 0.3, 0.01, 100.0, "m", "smaller depth is not used",
     "lower: artefacts close to the lens are used; higher: near surfaces are missing"},
    {"max_depth", &DepthNoise::max_depth, 5.0, 0.02, 1000.0, "m", "larger depth is not used",
     "lower: the background is missing; higher: noisy background, and more memory"},
});
static_assert(are_valid_fields(kDepthNoiseFields));

}  // namespace

DepthNoise::DepthNoise() { set_defaults(*this, kDepthNoiseFields); }

DepthNoise::DepthNoise(double min_depth_in, double max_depth_in) : DepthNoise() {
  min_depth = min_depth_in;
  max_depth = max_depth_in;
}

OptionSection section_of(DepthNoise& noise) {
  OptionSection section = make_section("depth_noise", noise, kDepthNoiseFields);
  section.check = [&noise]() -> std::optional<Error> {
    if (noise.min_depth < noise.max_depth) return std::nullopt;
    return Error{.message = "max_depth is not greater than min_depth",
                 .hint = "write the range in which the sensor measures"};
  };
  return section;
}

double DepthNoise::depth_std(double z, double incidence) const {
  // The term diverges at 90 degrees.
  const double angle = std::clamp(incidence, 0.0, 89.0 * std::numbers::pi / 180.0);
  const double complement = 0.5 * std::numbers::pi - angle;
  return depth_std(z) + grazing / std::sqrt(z) * (angle * angle) / (complement * complement);
}

}  // namespace pcavr
