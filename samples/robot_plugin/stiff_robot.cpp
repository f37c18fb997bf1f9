// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A robot plugin: makes a vendor's controller available to `pcavr robot-site` as a shared library
// with the functions below. This one simulates a robot whose tool follows its setpoint with a time
// constant of 20 ms, over a table of 5000 N/m; it tracks no objects. Use it as
// `--plugin libstiff_robot.so` or, for another height of the table in millimetres,
// `--plugin libstiff_robot.so,50`.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "pcavr/pipeline/robot_plugin.h"

namespace {

constexpr double kTimeConstant = 0.02;  // [s]
constexpr double kStiffness = 5000.0;   // [N/m] of the table
constexpr double kStart[3] = {0.2, 0.0, 0.3};

struct StiffRobot {
  double table = 0.0;  // [m] height
  double tip[3] = {kStart[0], kStart[1], kStart[2]};
  double last_t = 0.0;  // [s]
};

// A real plugin would connect to the vendor's controller here.
void* open(const char* options, const char* const* objects, size_t object_count, char* error,
           size_t error_size) {
  static_cast<void>(objects);  // a real one would look up what it can track
  static_cast<void>(object_count);
  char* end = nullptr;
  const double millimetres = *options == '\0' ? 0.0 : std::strtod(options, &end);
  const bool is_number = *options == '\0' || *end == '\0';
  if (!is_number || !(millimetres >= 0.0 && millimetres <= 1000.0)) {
    std::snprintf(error, error_size, "'%s' is not a height from 0 to 1000 mm", options);
    return nullptr;
  }
  auto* robot = new (std::nothrow) StiffRobot;
  if (robot != nullptr) robot->table = 1e-3 * millimetres;
  return robot;
}

void close(void* robot) { delete static_cast<StiffRobot*>(robot); }

// A real plugin would send the setpoint to the controller, and read its newest samples, here.
int exchange(void* given, double t, const pcavr_robot_command* command, pcavr_robot_state* state) {
  auto& robot = *static_cast<StiffRobot*>(given);
  const double dt = t - robot.last_t;
  robot.last_t = t;
  const double gain = std::clamp(dt / kTimeConstant, 0.0, 1.0);
  for (int i = 0; i < 3; ++i) {
    if (command != nullptr) robot.tip[i] += gain * (command->tip[i] - robot.tip[i]);
    state->tip[i] = robot.tip[i];
  }
  state->has_tool = 1;
  state->has_wrench = 1;
  state->force[2] = -kStiffness * std::max(robot.table - robot.tip[2], 0.0);
  return 0;
}

constexpr pcavr_robot_plugin kPlugin = {
    sizeof(pcavr_robot_plugin), PCAVR_ROBOT_PLUGIN_ABI, "stiff robot", open, close, exchange};

}  // namespace

const pcavr_robot_plugin* pcavr_get_robot_plugin(void) { return &kPlugin; }
