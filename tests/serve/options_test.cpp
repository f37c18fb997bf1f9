// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <string>

#include <gtest/gtest.h>

#include "pcavr/serve/content.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"

#include "serve/a_world.hpp"
#include "serve/live_sessions.hpp"
#include "serve/pulse_generator.hpp"
#include "serve/server_message_reader.hpp"
#include "support/option_defaults.hpp"

namespace pcavr {
namespace {

TEST(ServeOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<SceneWorldOptions>();
  test::expect_documented_defaults<VibrationOptions>();
  test::expect_documented_defaults<LiveWorldOptions>();
  test::expect_documented_defaults<ServerOptions>();
  test::expect_documented_defaults<ContentOptions>();
}

/// Amplitude `time` [s] after a first contact with a force of a tenth of full scale.
double amplitude_after(double time, const VibrationOptions& options) {
  PulseGenerator generator(0, 10.0, options);
  HapticWorldState state;
  state.touches_scan = true;
  state.force_base = {1.0, 0.0, 0.0};
  for (double t = 0.0; t < time; t += 0.001) generator.step(state, 0.001);
  return generator.amplitude();
}

TEST(ServeOptions, VibrationHasTheGivenDurationAndAmplitude) {
  VibrationOptions options;
  EXPECT_LT(amplitude_after(0.1, options), 0.99);
  EXPECT_NEAR(amplitude_after(0.5, options), 0.05, 1e-6);
  options.max_vibration = 1.0;
  EXPECT_NEAR(amplitude_after(0.5, options), 0.1, 1e-6);
  options.pulse_duration = 0.2;
  EXPECT_EQ(amplitude_after(0.1, options), 1.0);
}

/// Whether a page that engaged the tool at 100 s still has it 1 s later.
bool has_tool_after_a_second(double tool_timeout) {
  const auto world = test::a_live_world();
  LiveSessions sessions(
      *world, {}, [](LiveSessions::PageId, std::vector<std::uint8_t>) {}, tool_timeout, 10.0);
  const auto page = sessions.join();
  const auto send = [&](std::uint32_t sequence, auto content) {
    EXPECT_TRUE(sessions.on_message(page, encode(PageMessage{{sequence, 100.0}, content}), 100.0));
  };
  send(1, LiveHello{});
  send(2, LiveCommand::take_tool);
  send(3, LiveTool{.is_engaged = true});
  sessions.check_timeouts(101.0);
  std::vector<std::uint8_t> bytes;
  sessions.write_state(page, 101.0, 0.0, bytes);
  const ServerMessage message = decode_server_message(bytes).value();
  return std::get<LiveState>(message.content).has_tool;
}

TEST(ServeOptions, AnUnresponsivePageLosesTheToolAfterItsTimeout) {
  EXPECT_FALSE(has_tool_after_a_second(ServerOptions().tool_timeout));
  EXPECT_TRUE(has_tool_after_a_second(2.0));
}

}  // namespace
}  // namespace pcavr
