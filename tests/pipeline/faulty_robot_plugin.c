/* SPDX-FileCopyrightText: The pcavr authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Faults of a robot plugin, one for each FAULT that it is built with; with FAULT_answers, invalid
 * samples at run time, by its options. In C, as the header allows. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "pcavr/pipeline/robot_plugin.h"

static char chosen_fault[32];

static void* open_robot(const char* options, const char* const* objects, size_t object_count,
                        char* error, size_t error_size) {
  snprintf(chosen_fault, sizeof chosen_fault, "%s", options);
  const int has_objects = object_count == 2 && strcmp(objects[1], "box_2") == 0;
  if (!has_objects || strcmp(options, "unplugged") == 0) {
    snprintf(error, error_size, "no robot on the bus");
    return NULL;
  }
  return chosen_fault;
}

static void close_robot(void* robot) { (void)robot; }

static int is_fault(const char* name) { return strcmp(chosen_fault, name) == 0; }

static int exchange(void* robot, double t, const pcavr_robot_command* command,
                    pcavr_robot_state* state) {
  (void)robot, (void)command;
  state->has_tool = state->has_wrench = state->has_object = 1;
  state->age_tool = 0.001;
  state->age_wrench = 0.002;
  state->age_object = 0.03;
  state->object = 1;
  state->object_position_std = 1e-4;
  state->object_rotation_std = 1e-3;
  if (is_fault("blind") || (is_fault("silent") && t > 0.1)) state->has_tool = 0;
  if (t < 0.1005 || t > 0.2005) return 0;
  if (is_fault("nan")) state->tip[1] = NAN;
  if (is_fault("far")) state->tip[1] = 1e9;
  if (is_fault("turn")) memset(state->quaternion, 0, sizeof state->quaternion);
  if (is_fault("future")) state->age_tool = -0.01;
  if (is_fault("old")) state->age_tool = 1e6;
  if (is_fault("force")) state->force[0] = INFINITY;
  if (is_fault("object")) state->object = 2;
  if (is_fault("certain")) state->object_position_std = 0.0;
  return is_fault("code") ? -7 : 0;
}

static int take_picture(void* robot, double t, pcavr_robot_picture* picture) {
  (void)robot, (void)t;
  static const unsigned char pixels[2 * 1 * 3] = {1, 2, 3, 4, 5, 6};
  picture->width = is_fault("wide") ? 1000000 : 2;
  picture->height = is_fault("flat") ? 0 : 1;
  picture->age = is_fault("late") ? -1.0 : 0.05;
  picture->rgb = is_fault("black") ? NULL : pixels;
  return is_fault("dark") ? 0 : 1;
}

static const pcavr_robot_plugin plugin = {
#if defined(FAULT_size)
    offsetof(pcavr_robot_plugin, take_picture) - 8,
#elif defined(FAULT_camera)
    offsetof(pcavr_robot_plugin, take_picture), /* of before there were pictures */
#else
    sizeof(pcavr_robot_plugin),
#endif
#if defined(FAULT_abi)
    PCAVR_ROBOT_PLUGIN_ABI + 1,
#else
    PCAVR_ROBOT_PLUGIN_ABI,
#endif
    "faulty robot",
    open_robot,
#if defined(FAULT_function)
    NULL,
#else
    close_robot,
#endif
    exchange,
    take_picture};

#if defined(FAULT_symbol)
const pcavr_robot_plugin* another_name(void);
const pcavr_robot_plugin* another_name(void) { return &plugin; }
#elif defined(FAULT_null)
const pcavr_robot_plugin* pcavr_get_robot_plugin(void) { return (void)&plugin, NULL; }
#else
const pcavr_robot_plugin* pcavr_get_robot_plugin(void) { return &plugin; }
#endif
