/* SPDX-FileCopyrightText: The pcavr authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * The interface of a shared library that pcavr can load as an operator's device: one function,
 * pcavr_get_device_plugin(). Plain C; docs/device-plugin.md describes how to wrap a vendor's SDK.
 *
 * Frame: x away from the operator, y to the left, z up; metres, newtons, seconds; quaternions
 * x y z w. The origin is the device's own: the clutch keeps the offset to the tool. */
#ifndef PCAVR_DEVICES_DEVICE_PLUGIN_H_
#define PCAVR_DEVICES_DEVICE_PLUGIN_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Incremented by changes that break binary compatibility with existing plugins. */
#define PCAVR_DEVICE_PLUGIN_ABI 1u

/* Feedback to the device. `size` is set by pcavr: fields beyond it do not exist. */
typedef struct pcavr_device_feedback {
  uint32_t size;
  uint32_t is_engaged; /* the clutch is closed: the force is for this hand */
  double force[3];     /* [N] on the hand; already limited in magnitude and rate */
  double pulse;        /* 0 to 1: vibration amplitude for devices without force feedback */
  double torque[3];    /* [N m] on the hand, about its grip; for devices of six axes */
} pcavr_device_feedback;

/* The state of the device. Initialized to zeros except `size` and the quaternion, 0 0 0 1. */
typedef struct pcavr_device_sample {
  uint32_t size;
  uint32_t is_present; /* 0: unplugged; tip and clutch are ignored */
  uint32_t is_engaged; /* the clutch is closed */
  uint32_t reserved;   /* 0 */
  double tip[3];       /* [m] */
  double quaternion[4];
  /* Emergency stop: held, or pressed since the last cycle. Also counts with a tip that is rejected,
   * and without is_present. Set it only if `size` is that of this header, or more. */
  uint32_t is_stop_pressed;
  uint32_t reserved2; /* 0 */
} pcavr_device_sample;

typedef struct pcavr_device_plugin {
  uint32_t size;    /* sizeof(pcavr_device_plugin) */
  uint32_t abi;     /* PCAVR_DEVICE_PLUGIN_ABI */
  const char* name; /* UTF-8, for display */
  /* Returns the device, or NULL and a one-line error message, at most `error_size` bytes with the
   * terminating zero. May take seconds. `options`: the user's text after the file name, or "". */
  void* (*open)(const char* options, char* error, size_t error_size);
  /* Called once, at the end, by any thread; no exchange runs then or later. Stops the force. */
  void (*close)(void* device);
  /* One cycle, 1000 a second, all from one thread: `t` ascends, in steps of about `dt` [s]. Must
   * not wait, lock or allocate; 50 us at most. Returns 0, or another value to skip this cycle. */
  int (*exchange)(void* device, double t, double dt, const pcavr_device_feedback* feedback,
                  pcavr_device_sample* sample);
} pcavr_device_plugin;

/* Exported by the library. The result must stay valid and constant while the library is loaded. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const pcavr_device_plugin*
pcavr_get_device_plugin(void);

#ifdef __cplusplus
}
#endif

#endif /* PCAVR_DEVICES_DEVICE_PLUGIN_H_ */
