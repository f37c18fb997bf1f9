// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>
#include <sched.h>

namespace pcavr {

/// The real-time priority of the calling thread; 0 without one.
[[nodiscard]] inline int real_time_priority() {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  ::pthread_getschedparam(::pthread_self(), &policy, &parameters);
  const int real_time = policy & ~SCHED_RESET_ON_FORK;
  return real_time == SCHED_RR || real_time == SCHED_FIFO ? parameters.sched_priority : 0;
}

/// Gives a thread on which a real-time loop of priority `loop` depends the one below it, so that a
/// loaded machine does not delay what the loop needs. Where there is one below, and the system
/// permits it.
inline void follow_real_time(pthread_t thread, int loop) {
  if (loop <= 1) return;
  const sched_param parameters{.sched_priority = loop - 1};
  static_cast<void>(::pthread_setschedparam(thread, SCHED_RR, &parameters));
}

}  // namespace pcavr
