/* SPDX-FileCopyrightText: The pcavr authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Faults of a plugin, one for each FAULT that it is built with; with FAULT_answers, invalid samples
 * at run time, by its options. In C, as the header allows. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pcavr/teleoperation/devices/device_plugin.h"

static char chosen_fault[32];

static void* open_device(const char* options, char* error, size_t error_size) {
  snprintf(chosen_fault, sizeof chosen_fault, "%s", options);
  if (strcmp(options, "unplugged") == 0) {
    snprintf(error, error_size, "no device on the bus");
    return NULL;
  }
  if (strcmp(options, "mute") == 0) return NULL;
  if (strcmp(options, "long") == 0) {
    memset(error, 'x', error_size);
    return NULL;
  }
  return chosen_fault;
}

static void close_device(void* device) { (void)device; }

static int exchange(void* device, double t, double dt, const pcavr_device_feedback* feedback,
                    pcavr_device_sample* sample) {
  (void)device, (void)dt, (void)feedback;
  sample->is_present = 1;
  sample->is_engaged = 1;
  sample->tip[0] = 0.1 * t;
  const int is_bad = t >= 0.1 && t < 0.2;
  if (is_bad && strcmp(chosen_fault, "nan") == 0) sample->tip[1] = NAN;
  if (is_bad && strcmp(chosen_fault, "far") == 0) sample->tip[1] = 1e9;
  if (is_bad && strcmp(chosen_fault, "turn") == 0)
    memset(sample->quaternion, 0, sizeof sample->quaternion);
  if (is_bad && strcmp(chosen_fault, "away") == 0) sample->is_present = 0;
  /* A press of one cycle, at a bad time: its tip is rejected. */
  sample->is_stop_pressed = strcmp(chosen_fault, "nan") == 0 && t > 0.1495 && t < 0.1505;
  if (is_bad && strcmp(chosen_fault, "code") == 0) return -1;
  return 0;
}

static const pcavr_device_plugin plugin = {
#if defined(FAULT_abi)
    sizeof(pcavr_device_plugin),
    PCAVR_DEVICE_PLUGIN_ABI + 1,
#elif defined(FAULT_size)
    sizeof(pcavr_device_plugin) - 8,
    PCAVR_DEVICE_PLUGIN_ABI,
#else
    sizeof(pcavr_device_plugin), PCAVR_DEVICE_PLUGIN_ABI,
#endif
    "faulty device",
    open_device,
#if defined(FAULT_function)
    NULL,
#else
    close_device,
#endif
    exchange};

#if defined(FAULT_symbol)
const pcavr_device_plugin* another_name(void);
const pcavr_device_plugin* another_name(void) { return &plugin; }
#elif defined(FAULT_null)
const pcavr_device_plugin* pcavr_get_device_plugin(void) { return (void)&plugin, NULL; }
#else
const pcavr_device_plugin* pcavr_get_device_plugin(void) { return &plugin; }
#endif
