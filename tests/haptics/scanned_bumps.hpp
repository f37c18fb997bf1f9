// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/model/triangle.hpp"
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

namespace pcavr::test {

inline ProxyOptions proxy_options(double radius, double friction, double max_motion_ratio = 1.0) {
  ProxyOptions options;
  options.radius = radius;
  options.friction = friction;
  options.max_motion_ratio = max_motion_ratio;
  return options;
}

/// An open sheet of 0.3 x 0.3 m with bumps of 4 mm every 5 to 6 cm, as a scan of `cells`^2 squares
/// of two triangles in random order, each vertex off by noise along z. Computes,
/// independently of any search structure, on which side of it a point lies and its distance.
class ScannedBumps {
 public:
  static constexpr double kSize = 0.3;  // [m]

  ScannedBumps(std::uint32_t cells, double noise, std::uint64_t seed)
      : cells_(cells), pitch_(kSize / cells) {
    Random random(seed);
    for (std::uint32_t j = 0; j <= cells; ++j) {
      for (std::uint32_t i = 0; i <= cells; ++i) {
        const double x = i * pitch_;
        const double y = j * pitch_;
        const double z = smooth_height(x, y) + noise * random.normal();
        mesh_.vertices.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
      }
    }
    for (std::uint32_t j = 0; j < cells; ++j) {
      for (std::uint32_t i = 0; i < cells; ++i) {
        mesh_.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh_.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
    for (std::size_t i = mesh_.triangles.size() - 1; i > 0; --i) {
      std::swap(mesh_.triangles[i], mesh_.triangles[random.below(i + 1)]);
    }
  }

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

  static double smooth_height(double x, double y) {
    return 0.004 * std::sin(2.0 * M_PI * x / 0.05) * std::sin(2.0 * M_PI * y / 0.06);
  }

  /// The height [m] of the sheet itself.
  [[nodiscard]] double height(double x, double y) const {
    const auto i = std::min(static_cast<std::uint32_t>(x / pitch_), cells_ - 1);
    const auto j = std::min(static_cast<std::uint32_t>(y / pitch_), cells_ - 1);
    const Eigen::Vector3d p(x, y, 0.0);
    const bool is_lower = x / pitch_ - i > y / pitch_ - j;
    const model::Triangle t = is_lower ? triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1))
                                       : triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    const Eigen::Vector3d n = t.doubled_area_normal();
    return t.a.z() - (n.x() * (x - t.a.x()) + n.y() * (y - t.a.y())) / n.z();
  }

  /// The distance [m] to the sheet, where it is under `reach`; else infinity.
  [[nodiscard]] double distance(const Eigen::Vector3d& p, double reach) const {
    const auto cell = [&](double v) {
      return static_cast<std::uint32_t>(std::clamp(v / pitch_, 0.0, cells_ - 1.0));
    };
    double best = std::numeric_limits<double>::infinity();
    for (std::uint32_t j = cell(p.y() - reach); j <= cell(p.y() + reach); ++j) {
      for (std::uint32_t i = cell(p.x() - reach); i <= cell(p.x() + reach); ++i) {
        for (const model::Triangle& t : {triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1)),
                                         triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1))}) {
          best = std::min(best, (model::closest_point(t, p) - p).norm());
        }
      }
    }
    return best;
  }

 private:
  [[nodiscard]] std::uint32_t at(std::uint32_t i, std::uint32_t j) const {
    return j * (cells_ + 1) + i;
  }
  [[nodiscard]] model::Triangle triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return {mesh_.vertices[a].cast<double>(), mesh_.vertices[b].cast<double>(),
            mesh_.vertices[c].cast<double>()};
  }

  std::uint32_t cells_;
  double pitch_;
  TriangleMesh mesh_;
};

/// A hand that presses up to 5 mm deep and slides at up to some 0.2 m/s over the bumps, lifting off
/// every 2 s; smooth, at random phases. Stays 2 cm inside the sheet.
class PressAndSlide {
 public:
  explicit PressAndSlide(std::uint64_t seed) {
    Random random(seed);
    for (double& phase : phases_) phase = random.uniform(0.0, 2.0 * M_PI);
  }

  [[nodiscard]] Eigen::Vector3d operator()(double t) const {
    const double x =
        0.15 + 0.07 * std::sin(1.3 * t + phases_[0]) + 0.05 * std::sin(0.83 * t + phases_[1]);
    const double y =
        0.15 + 0.07 * std::sin(1.1 * t + phases_[2]) + 0.05 * std::sin(0.71 * t + phases_[3]);
    const double press = -0.0025 + 0.0025 * std::sin(9.0 * t + phases_[4]);
    const double within = std::fmod(t, 2.0) / 2.0;
    const double lift =
        within > 0.85 ? 0.012 * std::pow(std::sin((within - 0.85) / 0.15 * M_PI), 2) : 0.0;
    return {x, y, ScannedBumps::smooth_height(x, y) + press + lift};
  }

 private:
  double phases_[5] = {};
};

}  // namespace pcavr::test
