// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A robot plugin whose tool is at its setpoint at once, and which does what is not allowed, by its
// options: "open" and "exchange" throw, "picture" throws in take_picture and in close. "throws"
// throws for half a second from 1 s on, "invalid" gives a position that is no number, "late"
// returns after 20 ms each time, and "stops" returns once after a second.
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>

#include "pcavr/pipeline/robot_plugin.h"

namespace {

struct Robot {
  std::string fault;
  double tip[3] = {0.2, 0.0, 0.1};
  bool has_stopped = false;
};
Robot robot;

bool is(const char* fault) { return robot.fault == fault; }

void* open(const char* options, const char* const*, size_t, char*, size_t) {
  robot = {options};
  if (is("open")) throw std::runtime_error("thrown by open");
  return &robot;
}
void close(void*) {
  if (is("picture")) throw std::runtime_error("thrown by close");
}
int exchange(void*, double t, const pcavr_robot_command* command, pcavr_robot_state* state) {
  using std::chrono::milliseconds;
  if (is("exchange") && t > 0.1) throw std::runtime_error("thrown by exchange");
  const bool misbehaves = t > 1.0 && t < 1.5;
  if (misbehaves && is("throws")) throw std::runtime_error("thrown for a while");
  if (misbehaves && is("late")) std::this_thread::sleep_for(milliseconds(20));
  if (misbehaves && is("stops") && !robot.has_stopped) {
    robot.has_stopped = true;
    std::this_thread::sleep_for(milliseconds(1000));
  }
  if (command != nullptr) std::memcpy(robot.tip, command->tip, sizeof robot.tip);
  std::memcpy(state->tip, robot.tip, sizeof robot.tip);
  if (misbehaves && is("invalid")) state->tip[1] = std::nan("");
  state->has_tool = state->has_wrench = 1;
  return 0;
}
int take_picture(void*, double, pcavr_robot_picture*) { throw 7; }

constexpr pcavr_robot_plugin kPlugin = {sizeof(pcavr_robot_plugin),
                                        PCAVR_ROBOT_PLUGIN_ABI,
                                        "misbehaving robot",
                                        open,
                                        close,
                                        exchange,
                                        take_picture};

}  // namespace

const pcavr_robot_plugin* pcavr_get_robot_plugin(void) { return &kPlugin; }
