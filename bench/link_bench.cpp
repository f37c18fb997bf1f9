// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Computing time of the link: aim at most 50 us a pair of messages (a command and a state), both
// ends and libzmq's own threads together. `loops_as_the_sites` is what the programs do: a command
// each millisecond, a state for each tenth, and no loop that waits for a message; its counter is
// the difference to the same loops without messages. `exchange` has both ends wait for each
// message, so that the system's wake-ups come to it, six a pair; on one CPU it is the work of the
// messages.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <sched.h>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/link_transport.hpp"

#include "link/every_message.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

void encode_and_decode_a_command(benchmark::State& state) {
  const LinkMessage message = test::every_message()[5];
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) {
    encode_link_message(message, bytes);
    benchmark::DoNotOptimize(decode_link_message(bytes));
  }
}
BENCHMARK(encode_and_decode_a_command);

void encode_and_decode_a_state(benchmark::State& state) {
  const LinkMessage message = test::every_message()[6];
  std::vector<std::uint8_t> bytes;
  for (auto _ : state) {
    encode_link_message(message, bytes);
    benchmark::DoNotOptimize(decode_link_message(bytes));
  }
}
BENCHMARK(encode_and_decode_a_state);

/// Both ends, encrypted, over loopback.
struct ConnectedLink {
  ConnectedLink() {
    while (!peer) {  // until connected
      send_command();
      server.wait(0.01);
      peer = receive_command();
    }
    while (receive_command()) continue;
  }

  void send_command() {
    encode_link_message(command, bytes_to_robot);
    client.send(bytes_to_robot);
  }
  [[nodiscard]] std::optional<std::string> receive_command() {
    const std::optional<LinkPacket> packet = server.receive();
    if (!packet) return std::nullopt;
    benchmark::DoNotOptimize(decode_link_message(packet->bytes));
    return packet->peer;
  }
  void send_state() {
    encode_link_message(answer, bytes_to_operator);
    server.send(*peer, bytes_to_operator);
  }
  [[nodiscard]] bool receive_state() {
    const std::optional<std::vector<std::uint8_t>> received = client.receive();
    if (received) benchmark::DoNotOptimize(decode_link_message(*received));
    return received.has_value();
  }

  TemporaryFolder keys;
  LinkKeys robot = generate(keys.path(), "robot");
  LinkKeys person = generate(keys.path(), "operator");
  LinkServer server = LinkServer::open({.keys = robot, .authorized = keys.path()}).value();
  LinkClient client =
      LinkClient::open({.port = server.port(), .keys = person, .robot_key = robot.public_key})
          .value();
  const LinkMessage command = test::every_message()[5];
  const LinkMessage answer = test::every_message()[6];
  std::vector<std::uint8_t> bytes_to_robot;     ///< the operator's thread
  std::vector<std::uint8_t> bytes_to_operator;  ///< the robot's thread
  std::optional<std::string> peer;

 private:
  static LinkKeys generate(const std::filesystem::path& folder, const char* name) {
    static_cast<void>(generate_link_keys(folder, name).value());
    return read_link_keys(folder / (std::string(name) + ".key")).value();
  }
};

/// One command to the robot's site and one state back.
void exchange(benchmark::State& state) {
  ConnectedLink link;
  for (auto _ : state) {
    link.send_command();
    while (!link.receive_command()) link.server.wait(0.1);
    link.send_state();
    while (!link.receive_state()) link.client.wait(0.1);
  }
}

constexpr int kLoopPriority = 20;  // the sites'
constexpr std::size_t kLoopCycles = 2000;
constexpr std::chrono::milliseconds kCycle(1);
constexpr std::size_t kCyclesPerState = 10;

[[nodiscard]] double process_cpu() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Runs `step` each millisecond with a site's priority.
template <typename Step>
[[nodiscard]] std::thread loop(Step step) {
  return std::thread([step] {
    const sched_param priority{.sched_priority = kLoopPriority};
    ::sched_setscheduler(0, SCHED_RR, &priority);
    auto next = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < kLoopCycles; ++i) {
      std::this_thread::sleep_until(next += kCycle);
      step(i);
    }
  });
}

/// CPU [s] a cycle of the loops of both sites.
[[nodiscard]] double loops_cpu(ConnectedLink& link, bool has_messages) {
  const double before = process_cpu();
  std::thread robot = loop([&](std::size_t i) {
    while (link.receive_command()) continue;
    if (has_messages && i % kCyclesPerState == 0) link.send_state();
  });
  std::thread person = loop([&](std::size_t) {
    while (link.receive_state()) continue;
    if (has_messages) link.send_command();
  });
  robot.join();
  person.join();
  return (process_cpu() - before) / static_cast<double>(kLoopCycles);
}

void loops_as_the_sites(benchmark::State& state) {
  ConnectedLink link;
  double messages = 0.0;
  for (auto _ : state) messages += loops_cpu(link, true) - loops_cpu(link, false);
  state.counters["us_a_pair"] = 1e6 * messages / static_cast<double>(state.iterations());
}
BENCHMARK(loops_as_the_sites)->Iterations(3)->Unit(benchmark::kMillisecond);

void exchange_a_command_and_a_state(benchmark::State& state) { exchange(state); }
BENCHMARK(exchange_a_command_and_a_state)->MeasureProcessCPUTime()->UseRealTime();

/// Threads inherit the CPUs of the one that starts them.
void exchange_a_command_and_a_state_on_one_cpu(benchmark::State& state) {
  cpu_set_t all;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  if (::sched_getaffinity(0, sizeof(all), &all) != 0 ||
      ::sched_setaffinity(0, sizeof(one), &one) != 0) {
    return state.SkipWithError("the CPUs of this thread can't be chosen");
  }
  exchange(state);
  ::sched_setaffinity(0, sizeof(all), &all);
}
BENCHMARK(exchange_a_command_and_a_state_on_one_cpu)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace pcavr
