/* SPDX-FileCopyrightText: The pcavr authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * What a shared library has to give so that pcavr can load it as an operator's device: one
 * function, pcavr_get_device_plugin(). Plain C; docs/device-plugin.md tells how to wrap a vendor's
 * SDK in it.
 *
 * Frame: x away from the operator, y to the left, z up; metres, newtons, seconds; quaternions
 * x y z w. The origin is the device's own: the clutch keeps the difference to the tool. */
#ifndef PCAVR_DEVICES_DEVICE_PLUGIN_H_
#define PCAVR_DEVICES_DEVICE_PLUGIN_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Counts up when a plugin that was built before could not be used any more. */
#define PCAVR_DEVICE_PLUGIN_ABI 1u

/* What the device is told. `size` is set by pcavr: a field that lies beyond it is not there. */
typedef struct pcavr_device_feedback {
  uint32_t size;
  uint32_t is_engaged; /* the clutch has closed: the force is for this hand */
  double force[3];     /* [N] on the hand; bounded in size and rate already */
  double pulse;        /* 0 to 1: what a device that has no force may shake with */
} pcavr_device_feedback;

/* What the device says. It comes in as all zeros but for `size` and the quaternion, 0 0 0 1. */
typedef struct pcavr_device_sample {
  uint32_t size;
  uint32_t is_present; /* 0: unplugged; nothing else is read then */
  uint32_t is_engaged; /* the clutch is held */
  uint32_t reserved;   /* 0 */
  double tip[3];       /* [m] */
  double quaternion[4];
} pcavr_device_sample;

typedef struct pcavr_device_plugin {
  uint32_t size;    /* sizeof(pcavr_device_plugin) */
  uint32_t abi;     /* PCAVR_DEVICE_PLUGIN_ABI */
  const char* name; /* UTF-8, for people */
  /* Gives the device, or NULL and a line of text why, at most `error_size` bytes with the zero.
   * May take seconds. `options` is what the user wrote after the file's name, "" for nothing. */
  void* (*open)(const char* options, char* error, size_t error_size);
  /* Once, at the end, by any thread; no exchange runs then or comes after. Ends the force. */
  void (*close)(void* device);
  /* One cycle, 1000 a second, all from one thread: `t` ascends, in steps of about `dt` [s]. Neither
   * waits, locks nor allocates: 50 us are plenty. 0, or anything else for a cycle to leave out. */
  int (*exchange)(void* device, double t, double dt, const pcavr_device_feedback* feedback,
                  pcavr_device_sample* sample);
} pcavr_device_plugin;

/* What the library exports. What it points to stays as it is while the library is loaded. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const pcavr_device_plugin*
pcavr_get_device_plugin(void);

#ifdef __cplusplus
}
#endif

#endif /* PCAVR_DEVICES_DEVICE_PLUGIN_H_ */
