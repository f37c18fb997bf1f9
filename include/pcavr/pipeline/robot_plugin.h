/* SPDX-FileCopyrightText: The pcavr authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * The interface of a shared library that robot-site can load as its robot: one function,
 * pcavr_get_robot_plugin(). Plain C; docs/robot-plugin.md describes how to wrap a vendor's
 * controller.
 *
 * Base frame of the scene, z up; metres, newtons, seconds, radians; quaternions x y z w. */
#ifndef PCAVR_PIPELINE_ROBOT_PLUGIN_H_
#define PCAVR_PIPELINE_ROBOT_PLUGIN_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Incremented by changes that break binary compatibility with existing plugins. */
#define PCAVR_ROBOT_PLUGIN_ABI 1u

/* The setpoint of a cycle. `size` is set by pcavr: fields beyond it do not exist. */
typedef struct pcavr_robot_command {
  uint32_t size;
  uint32_t reserved; /* 0 */
  double tip[3];     /* [m] within the limits of the robot's site */
  double quaternion[4]; /* that of the tool's first sample */
} pcavr_robot_command;

/* What was measured since the last cycle, at most one sample of each kind. Initialized to zeros
 * except `size` and the quaternions, 0 0 0 1. */
typedef struct pcavr_robot_state {
  uint32_t size;
  uint32_t has_tool;   /* 1: a new sample */
  uint32_t has_wrench;
  uint32_t has_object;
  double age_tool; /* [s] from the measurement to this call, >= 0 */
  double age_wrench;
  double age_object;
  double tip[3];        /* [m] */
  double quaternion[4]; /* of the tool */
  double force[3];      /* [N] that the tool exerts on what it touches */
  double torque[3];     /* [N m] the same, about the tip */
  uint32_t object;      /* index in the list given to open() */
  uint32_t reserved;    /* 0 */
  double object_position[3]; /* [m] of its frame's origin */
  double object_quaternion[4];
  double object_position_std; /* [m] over all three axes; > 0 */
  double object_rotation_std; /* [rad] > 0 */
} pcavr_robot_state;

/* What the robot's camera sees. `size` is set by pcavr, the rest to zeros. */
typedef struct pcavr_robot_picture {
  uint32_t size;
  uint32_t width; /* [pixels] 1 to 4096 */
  uint32_t height;
  uint32_t reserved;        /* 0 */
  double age;               /* [s] from its exposure to this call, >= 0 */
  const unsigned char* rgb; /* 3 bytes a pixel, row by row from the top; valid until the next call */
} pcavr_robot_picture;

typedef struct pcavr_robot_plugin {
  uint32_t size;    /* sizeof(pcavr_robot_plugin) */
  uint32_t abi;     /* PCAVR_ROBOT_PLUGIN_ABI */
  const char* name; /* UTF-8, for display */
  /* Returns the robot, or NULL and a one-line error message, at most `error_size` bytes with the
   * terminating zero. May take seconds. `options`: the user's text after the file name, or "".
   * `objects`: names of the scene's objects, valid during the call. */
  void* (*open)(const char* options, const char* const* objects, size_t object_count, char* error,
                size_t error_size);
  /* Called once, at the end; no exchange runs then or later. The robot stops. */
  void (*close)(void* robot);
  /* One cycle, 1000 a second, all from one thread: `t` ascends [s]. `command` is NULL until the
   * tool's first sample. Must not wait, lock or allocate; 50 us at most. Returns 0, or another value
   * if the robot can't follow: then nothing of the state is used. */
  int (*exchange)(void* robot, double t, const pcavr_robot_command* command,
                  pcavr_robot_state* state);
  /* May be NULL, or missing from a plugin of a smaller `size`: the robot has no camera. From one
   * thread, which is not that of exchange(), at most 10 times a second; may wait. Returns 1 with a
   * picture that is newer than the last one, 0 without one. */
  int (*take_picture)(void* robot, double t, pcavr_robot_picture* picture);
} pcavr_robot_plugin;

/* Exported by the library. The result must stay valid and constant while the library is loaded. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const pcavr_robot_plugin*
pcavr_get_robot_plugin(void);

#ifdef __cplusplus
}
#endif

#endif /* PCAVR_PIPELINE_ROBOT_PLUGIN_H_ */
