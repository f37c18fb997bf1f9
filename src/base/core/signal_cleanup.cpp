// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/signal_cleanup.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <thread>

#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include "base/core/partial_registry.hpp"

namespace pcavr {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP, SIGPIPE};
constexpr int kSignalExit = 128;  ///< added to the signal's number, as shells do

// A handler may only call async-signal-safe functions, and removing a tree of files is not one: the
// handler wakes a thread for that.
std::atomic<int> signal_received{0};
static_assert(std::atomic<int>::is_always_lock_free);
sem_t wake_up;

void on_signal(int signal) {
  const int saved = errno;
  int none = 0;
  if (signal_received.compare_exchange_strong(none, signal)) ::sem_post(&wake_up);
  errno = saved;
}

void wait_and_clean() {
  while (::sem_wait(&wake_up) != 0) {
  }
  PartialRegistry::instance().remove_all_and_lock();
  ::_exit(kSignalExit + signal_received.load());
}

}  // namespace

void install_signal_cleanup() {
  static std::atomic<bool> is_installed{false};
  if (is_installed.exchange(true)) return;
  PartialRegistry::instance();
  ::sem_init(&wake_up, 0, 0);
  std::thread(wait_and_clean).detach();
  for (const int signal : kSignals) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);
}

void wait_if_interrupted() {
  while (signal_received.load() != 0) ::pause();
}

}  // namespace pcavr
