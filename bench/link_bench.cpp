// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Computing time of the link: aim at most 50 us a pair of messages (a command and a state), both
// ends and libzmq's own threads together (the column CPU of the process). On one CPU it is the work
// of the messages. On all of them the system's wake-ups come to that, six a pair: libzmq's threads
// have real-time priority, which it moves between CPUs (in a virtual machine some 25 us each).
#include <filesystem>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>
#include <sched.h>

#include "pcavr/link/link_message.hpp"
#include "pcavr/link/link_transport.hpp"

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

/// One command to the robot's site and one state back, encrypted, over loopback.
void exchange(benchmark::State& state) {
  const TemporaryFolder folder;
  const std::filesystem::path keys = folder.path();
  static_cast<void>(generate_link_keys(keys, "robot").value());
  static_cast<void>(generate_link_keys(keys, "operator").value());
  LinkServer server =
      LinkServer::open({.keys = read_link_keys(keys / "robot.key").value(), .authorized = keys})
          .value();
  LinkClient client =
      LinkClient::open({.port = server.port(),
                        .keys = read_link_keys(keys / "operator.key").value(),
                        .robot_key = read_public_link_key(keys / "robot.pub").value()})
          .value();
  const LinkMessage command = test::every_message()[5];
  const LinkMessage answer = test::every_message()[6];
  std::vector<std::uint8_t> bytes;
  std::optional<LinkPacket> packet;
  while (!packet) {  // until connected
    encode_link_message(command, bytes);
    client.send(bytes);
    server.wait(0.01);
    packet = server.receive();
  }
  while (server.receive()) continue;
  for (auto _ : state) {
    encode_link_message(command, bytes);
    client.send(bytes);
    for (packet.reset(); !packet; packet = server.receive()) server.wait(0.1);
    benchmark::DoNotOptimize(decode_link_message(packet->bytes));
    encode_link_message(answer, bytes);
    server.send(packet->peer, bytes);
    std::optional<std::vector<std::uint8_t>> received;
    for (; !received; received = client.receive()) client.wait(0.1);
    benchmark::DoNotOptimize(decode_link_message(*received));
  }
}

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
