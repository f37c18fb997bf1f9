// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A robot plugin: makes a vendor's controller available to `pcavr robot-site` as a shared library
// with the functions below. This one simulates a robot whose tool follows its setpoint with a time
// constant of 20 ms, over a table of 5000 N/m; it tracks no objects, and its camera sees the tool's
// height over the table. Use it as
// `--plugin libstiff_robot.so` or, for another height of the table in millimetres,
// `--plugin libstiff_robot.so,50`.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "pcavr/pipeline/robot_plugin.h"

namespace {

constexpr double kTimeConstant = 0.02;           // [s]
constexpr double kStiffness = 5000.0;            // [N/m] of the table
constexpr unsigned kWidth = 160, kHeight = 120;  // [pixels]
constexpr double kPixel = 0.005;                 // [m]
constexpr double kStart[3] = {0.2, 0.0, 0.3};

struct StiffRobot {
  double table = 0.0;  // [m] height
  double tip[3] = {kStart[0], kStart[1], kStart[2]};
  double last_t = 0.0;  // [s]
  // The camera's thread is not that of exchange().
  std::atomic<double> seen_height{kStart[2]};  // [m] of the tip
  unsigned char rgb[3 * kWidth * kHeight] = {};
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
  robot.seen_height.store(robot.tip[2], std::memory_order_relaxed);
  state->has_tool = 1;
  state->has_wrench = 1;
  state->force[2] = -kStiffness * std::max(robot.table - robot.tip[2], 0.0);
  return 0;
}

// The picture is taken from the side, with the table's edge in the lowest row. A real plugin would
// copy the newest image of its camera here, and return 0 where there is none since the last call.
int take_picture(void* given, double t, pcavr_robot_picture* picture) {
  static_cast<void>(t);
  auto& robot = *static_cast<StiffRobot*>(given);
  const double height = robot.seen_height.load(std::memory_order_relaxed) - robot.table;
  const double row = static_cast<double>(kHeight) - 1.0 - height / kPixel;  // of the tip
  for (unsigned y = 0; y < kHeight; ++y) {
    const bool is_table = y == kHeight - 1;
    for (unsigned x = 0; x < kWidth; ++x) {
      const bool is_tool = x / 8 == kWidth / 16 && y <= row;
      unsigned char* const pixel = robot.rgb + 3 * (y * kWidth + x);
      pixel[0] = is_tool ? 200 : 40;
      pixel[1] = is_table ? 120 : 40;
      pixel[2] = 40;
    }
  }
  picture->width = kWidth;
  picture->height = kHeight;
  picture->rgb = robot.rgb;
  return 1;
}

constexpr pcavr_robot_plugin kPlugin = {sizeof(pcavr_robot_plugin),
                                        PCAVR_ROBOT_PLUGIN_ABI,
                                        "stiff robot",
                                        open,
                                        close,
                                        exchange,
                                        take_picture};

}  // namespace

const pcavr_robot_plugin* pcavr_get_robot_plugin(void) { return &kPlugin; }
