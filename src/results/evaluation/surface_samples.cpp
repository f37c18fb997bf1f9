// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "surface_samples.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Low-discrepancy (quasi-random) points in the unit square: multiples of the powers of 1/g, where
/// g^3 = g + 1, modulo 1 [Roberts 2018, the R2 sequence]. A share of an area is exact to about one
/// sample; with n independent random points, to about sqrt(n) samples.
class R2Sequence {
 public:
  explicit R2Sequence(Random& random) : u_(random.uniform()), v_(random.uniform()) {}

  Eigen::Vector2d next() {
    constexpr double kStepU = 0.7548776662466927;  // 1 / g
    constexpr double kStepV = 0.5698402909980532;  // 1 / g^2
    u_ = std::fmod(u_ + kStepU, 1.0);
    v_ = std::fmod(v_ + kStepV, 1.0);
    return {u_, v_};
  }

 private:
  double u_;
  double v_;
};

}  // namespace

std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, double spacing,
                                          std::uint64_t seed) {
  PCAVR_REQUIRE(spacing > 0.0, spacing);
  const double cell = spacing * spacing;
  Random random(seed);
  R2Sequence points(random);
  std::vector<SurfaceSample> samples;
  // Systematic sampling: one sample in each cell of the cumulative area.
  const double start = cell * random.uniform();
  double next = start;
  double area_passed = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[triangle[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[triangle[2]].cast<double>();
    const Eigen::Vector3d doubled_area = (b - a).cross(c - a);
    area_passed += 0.5 * doubled_area.norm();
    for (; next < area_passed; next = start + cell * static_cast<double>(samples.size())) {
      // Points beyond the square's diagonal are reflected into the triangle.
      Eigen::Vector2d uv = points.next();
      if (uv.sum() > 1.0) uv = Eigen::Vector2d::Ones() - uv;
      const Eigen::Vector3d point = a + uv.x() * (b - a) + uv.y() * (c - a);
      samples.push_back({point.cast<float>(), doubled_area.normalized().cast<float>()});
    }
  }
  return samples;
}

}  // namespace pcavr
