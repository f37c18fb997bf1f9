// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Time per cycle of the haptic tool on a scan of a million triangles, for each of 20 000 steps
// along a path, compared with Embree's closest point to the same tips. The minimum over several
// runs is taken for each step, which excludes other load. Targets: median 5, p99 15, max 50 us.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/teleoperation/haptics/haptic_tool.hpp"

#include "haptics/scanned_bumps.hpp"

namespace {

constexpr int kSteps = 20'000;
constexpr int kRuns = 5;
constexpr double kCycle = 0.001;  // [s]

std::vector<Eigen::Vector3d> tips() {
  const pcavr::test::PressAndSlide hand(17);
  std::vector<Eigen::Vector3d> all;
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * kCycle;
    all.push_back(hand(t) + Eigen::Vector3d(0.0, 0.0, std::max(0.0, 0.02 - 0.1 * t)));
  }
  return all;
}

template <typename Step>
void time_steps(const std::string& what, const Step& step) {
  std::vector<double> fastest(kSteps, 1e9);
  for (int run = 0; run < kRuns; ++run) {
    for (int i = 0; i < kSteps; ++i) {
      const auto start = std::chrono::steady_clock::now();
      step(i);
      const std::chrono::duration<double, std::micro> elapsed =
          std::chrono::steady_clock::now() - start;
      double& best = fastest[static_cast<std::size_t>(i)];
      best = std::min(best, elapsed.count());
    }
  }
  std::sort(fastest.begin(), fastest.end());
  std::printf("%-52s p50 %6.2f  p99 %6.2f  p99.9 %6.2f  max %6.2f us\n", what.c_str(),
              fastest[kSteps / 2], fastest[kSteps * 99 / 100], fastest[kSteps * 999 / 1000],
              fastest.back());
}

void time_on(double noise) {
  const pcavr::test::ScannedBumps bumps(707, noise, 5);
  const std::vector<Eigen::Vector3d> path = tips();
  const std::string surface = "noise " + std::to_string(noise * 1e3).substr(0, 3) + " mm: ";
  using pcavr::test::proxy_options;
  for (const pcavr::ProxyOptions& options :
       {proxy_options(0.001, 0.0), proxy_options(0.001, 0.4), proxy_options(0.001, 0.0, 2.0),
        proxy_options(0.0001, 0.0)}) {
    pcavr::HapticTool tool(bumps.mesh(), options, {});
    char proxy[64];
    std::snprintf(proxy, sizeof proxy, "proxy %.1f mm, friction %.1f, motion %.0f",
                  1e3 * options.radius, options.friction, options.max_motion_ratio);
    time_steps(surface + proxy, [&](int i) {
      const Eigen::Vector3d& tip = path[static_cast<std::size_t>(i)];
      if (i == 0 && !tool.reset(tip)) std::puts("the path starts inside");
      (void)tool.step(tip, kCycle);
    });
  }
  const pcavr::SurfaceQuery query(bumps.mesh());
  time_steps(surface + "Embree's closest point", [&](int i) {
    const Eigen::Vector3f tip = path[static_cast<std::size_t>(i)].cast<float>();
    if (!query.closest(tip, 1.0F)) std::puts("no closest point");
  });
}

}  // namespace

int main() {
  time_on(0.0);
  time_on(0.0003);
}
