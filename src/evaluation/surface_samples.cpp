// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "surface_samples.hpp"

#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/core/random.hpp"

namespace pcavr {
namespace {

/// Points that fill the unit square evenly: multiples of the powers of 1/g, where g^3 = g + 1, less
/// their whole part [Roberts 2018, the R2 sequence]. A share of an area is known to about one
/// sample, where independent random points would know it to the root of their number.
class EvenPoints {
 public:
  explicit EvenPoints(Random& random) : u_(random.uniform()), v_(random.uniform()) {}

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
  EvenPoints points(random);
  std::vector<SurfaceSample> samples;
  // The triangles laid end to end by area; one sample falls into each cell of that line.
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
      // The half of the square beyond its diagonal is turned onto the other: the triangle.
      Eigen::Vector2d uv = points.next();
      if (uv.sum() > 1.0) uv = Eigen::Vector2d::Ones() - uv;
      const Eigen::Vector3d point = a + uv.x() * (b - a) + uv.y() * (c - a);
      samples.push_back({point.cast<float>(), doubled_area.normalized().cast<float>()});
    }
  }
  return samples;
}

}  // namespace pcavr
