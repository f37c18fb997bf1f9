// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The complete 1 kHz cycle with a connected page: device, proxy, contact, friction, ten bodies,
// publish. Also the latency from a tool sample sent by the page to the first state that used
// it.
//
// Usage: pcavr_bench_serve [seconds]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/serve/server.hpp"

#include "serve/a_world.hpp"
#include "serve/page_client.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class NoScene final : public ContentSource {
 public:
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view) const override {
    return std::shared_ptr<const Content>();
  }
};

constexpr double kWarmUp = 2.0;  ///< [s]
constexpr double kRate = 72.0;   ///< [Hz]

/// Ten boxes in two rows on the scanned table (32 000 triangles, 0.3 mm of noise).
HapticWorldModel ten_boxes() {
  HapticWorldModel model = test::one_box_on_a_table(3e-4);
  const WorldBody box = model.world.bodies.front();
  model.world.bodies.clear();
  for (int i = 0; i < 10; ++i) {
    WorldBody body = box;
    body.model.name = "box" + std::to_string(i);
    const Eigen::Vector3d place(-0.38 + 0.19 * (i % 5), i < 5 ? -0.15 : 0.15,
                                box.T_base_object.translation().z());
    body.T_base_object = Pose(box.T_base_object.rotation(), place);
    model.world.bodies.push_back(body);
  }
  return model;
}

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// A circular hand motion among the boxes that presses some of them and the table.
Eigen::Vector3f place_at(double t, const Eigen::Vector3f& start) {
  const double turn = 2.0 * 3.14159265358979 * 0.25 * t;
  return start + Eigen::Vector3d(0.15 * std::sin(turn), 0.2 * (1.0 - std::cos(turn)),
                                 -0.03 * (1.0 - std::cos(3.0 * turn)))
                     .cast<float>();
}

int run(double seconds) {
  const TemporaryFolder page_folder;
  if (!write_file(page_folder.path() / "index.html", "")) return 1;
  Expected<HapticWorld> haptic = HapticWorld::create(ten_boxes());
  if (!haptic) return 1;
  LiveWorldOptions live_options;
  live_options.p_base_tool_start = {0.0, 0.0, 0.1};
  LiveWorld world(std::move(*haptic), std::make_unique<RemoteDevice>(), live_options);
  const NoScene scene;
  ServerOptions options;
  options.port = 0;
  options.page = page_folder.path();
  options.rate = kRate;
  Expected<LiveServer> server = LiveServer::open(options, world, scene);
  if (!server) return 1;
  const Expected<std::vector<std::string>> notes = world.start();
  if (!notes) return 1;
  for (const std::string& note : *notes) std::printf("note: %s\n", note.c_str());
  std::thread network([&] { server->run(); });

  test::PageClient page(server->port());
  page.send_hello();
  page.send_message(LiveCommand::take_tool);
  std::vector<double> latencies;
  std::vector<double> ages;
  std::uint32_t late_before = 0;
  std::uint32_t cycles_before = 0;
  LiveState last;
  Random random(1);
  bool is_first = true;
  bool is_warm = false;
  Eigen::Vector3f start = Eigen::Vector3f::Zero();
  double used_before = std::nan("");
  const double begin = LiveWorld::clock();
  while (LiveWorld::clock() - begin < kWarmUp + seconds) {
    const auto state = page.receive_next<LiveState>();
    if (!state) return 1;
    const double now = LiveWorld::clock();
    if (is_first) start = state->p_base_hip;
    is_first = false;
    if (!is_warm && now - begin > kWarmUp) {
      is_warm = true;
      late_before = state->late_cycles;
      cycles_before = state->cycles;
    }
    // The first state that has used a sample: round-trip latency.
    if (is_warm && state->page_clock != used_before && !std::isnan(state->page_clock)) {
      latencies.push_back(now - state->page_clock);
      ages.push_back(state->state_age);
    }
    used_before = state->page_clock;
    last = *state;
    // A page's frames are not synchronized with the server: a random phase between two states.
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(0.0, 0.9 / kRate)));
    const double t = LiveWorld::clock() - begin;
    page.send_message(LiveTool{.p_base_tip = place_at(std::max(0.0, t - 0.2), start),
                               .is_engaged = t > 0.2,
                               .device = LiveInputDevice::controller});
  }
  page.close();
  server->stop();
  network.join();
  world.stop();
  const std::uint32_t cycles = last.cycles - cycles_before;
  std::printf("cycles %u, late %u (%.3f %%)\n", cycles, last.late_cycles - late_before,
              100.0 * (last.late_cycles - late_before) / cycles);
  const CycleTimes times = world.times();
  std::printf("cycle  p50 %.1f us, p99 %.1f us, p99.9 %.1f us, max %.1f us\n", 1e6 * times.median,
              1e6 * times.p99, 1e6 * times.p999, 1e6 * times.longest);
  std::printf("sample to state that has used it: p50 %.2f ms, p99 %.2f ms (72 Hz, loopback)\n",
              1e3 * quantile(latencies, 0.5), 1e3 * quantile(latencies, 0.99));
  std::printf("age of a state when it is sent: p50 %.2f ms, p99 %.2f ms\n",
              1e3 * quantile(ages, 0.5), 1e3 * quantile(ages, 0.99));
  return 0;
}

}  // namespace
}  // namespace pcavr

int main(int argc, char** argv) { return pcavr::run(argc > 1 ? std::atof(argv[1]) : 20.0); }
