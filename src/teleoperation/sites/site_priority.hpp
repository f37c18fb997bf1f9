// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include <sched.h>

#include "pcavr/base/core/observer.hpp"

namespace pcavr {

/// Gives the calling thread, which runs a site's loop, real-time priority: on a loaded machine it
/// would otherwise miss its cycles and its watchdogs would end the session. Threads that it starts
/// do not inherit it. One warning if the system does not permit it. The priority is that of
/// `pcavr serve`'s world by default ("live.thread_priority").
inline void request_site_priority(const Observer& observer) {
  constexpr int kSitePriority = 20;
  const sched_param priority{.sched_priority = kSitePriority};
  if (::sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &priority) == 0) return;
  observer.on_warning(std::string("the site runs without real-time priority (") +
                      std::strerror(errno) + "); allow it with ulimit -r " +
                      std::to_string(kSitePriority));
}

}  // namespace pcavr
