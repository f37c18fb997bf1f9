// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// From arrays in memory to mu, without a file. The arrays are those of your log: here they come
// from a box of 1.2 kg that a tip pushes along x against Coulomb friction, mu 0.3.
//   10_identify_your_arrays
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include <pcavr/base/model/cad_model.hpp>
#include <pcavr/pipeline/identify.hpp>

namespace {

constexpr double kMass = 1.2, kGravity = 9.81, kMu = 0.3;
constexpr double kTipRadius = 0.01, kHalfEdge = 0.05;  // [m]

/// Your log: base frame, z up, SI. All times are on one clock; rates may differ.
struct Log {
  std::vector<double> t;
  std::vector<std::array<double, 3>> tip;    // centre of the spherical tip
  std::vector<std::array<double, 3>> force;  // that the tip exerts
  std::vector<std::array<double, 3>> box;    // position of its centre, which does not turn
};

/// Where the tip is: it touches slowly, pushes by 60 mm and goes back a little, six times, at up to
/// 31, 63 and 126 mm/s, since one speed does not show Coulomb and viscous friction apart.
double commanded_tip(double t) {
  const int push = static_cast<int>(t / 5.0);
  const double begin = -0.0605 + 0.0595 * push, s = t - 5.0 * push;
  const double duration = 3.0 / (1 << push % 3);
  const double pushed = 0.5 - 0.5 * std::cos(std::numbers::pi * std::min(s / duration, 1.0));
  return begin + 0.06 * pushed - 0.0005 * std::clamp(s - 3.5, 0.0, 1.0);
}

Log pushed_box() {
  Log log;
  std::mt19937 random(1);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same arrays each time
  std::normal_distribution<double> noise;
  double x = 0.0, v = 0.0, last_depth = 0.0;
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 300000; ++i) {
    const double t = kStep * i, tip = commanded_tip(t);
    const double depth = std::max(tip + kTipRadius - (x - kHalfEdge), 0.0);
    const double force =
        depth > 0.0 ? std::max(10000.0 * depth + 100.0 * (depth - last_depth) / kStep, 0.0) : 0.0;
    last_depth = depth;
    const double friction = kMu * kMass * kGravity;
    const bool rests = v <= 0.0 && force <= friction;
    v = rests ? 0.0 : std::max(v + kStep / kMass * (force - friction), 0.0);
    x += kStep * v;
    if (i % 20 != 0) continue;  // 500 Hz
    log.t.push_back(t);
    log.tip.push_back({tip + 2e-5 * noise(random), 0.0, kHalfEdge});
    log.force.push_back({force + 0.05 * noise(random), 0.05 * noise(random), 0.0});
    log.box.push_back({x + 1e-4 * noise(random), 0.0, kHalfEdge});
  }
  return log;
}

pcavr::TriangleMesh cube() {
  pcavr::TriangleMesh mesh;
  const auto edge = static_cast<float>(kHalfEdge);
  for (const float x : {-edge, edge}) {
    for (const float y : {-edge, edge}) {
      for (const float z : {-edge, edge}) mesh.vertices.emplace_back(x, y, z);
    }
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

Eigen::Vector3d vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

pcavr::Expected<pcavr::Identification> identify(const Log& log) {
  const auto model = pcavr::make_cad_model(cube(), "box", "the arrays");
  if (!model) return model.error();
  pcavr::IdentificationInput input;
  input.tool_radius = kTipRadius;
  input.t_tool = input.t_force = log.t;
  pcavr::IdentifiableObject box{
      .name = "box",
      .model = *model,
      .T_base_object = pcavr::Pose::from_translation(vector(log.box.front())),
      .mass = kMass};
  for (std::size_t i = 0; i < log.t.size(); ++i) {
    input.p_base_tip.push_back(vector(log.tip[i]));
    input.force_base.push_back(vector(log.force[i]));
    box.tracked.push_back({.t = log.t[i],
                           .T_base_object = pcavr::Pose::from_translation(vector(log.box[i])),
                           .position_std = 1e-4,
                           .rotation_std = 1e-3});
  }
  input.objects.push_back(std::move(box));
  return pcavr::identify(input, pcavr::IdentificationGoal::friction);
}

}  // namespace

int main() {
  const auto found = identify(pushed_box());
  if (!found) return std::fprintf(stderr, "%s\n", found.error().to_string().c_str()), 1;
  for (const pcavr::ParameterFinding& finding : found->objects.front().findings) {
    if (finding.is_excited) {
      std::printf("%-30s %.4g +- %.2g %s\n", finding.name.c_str(), finding.value,
                  finding.std.value_or(0.0), finding.unit.c_str());
    } else {
      std::printf("%-30s not excited: %s\n", finding.name.c_str(), finding.remark.c_str());
    }
  }
  return 0;
}
