// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

#include <grp.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

/// A child process that runs a function; killed at the end of its scope if it still runs then.
class ForkedProcess {
 public:
  /// Returns when the child calls report_ready() or has ended.
  template <typename Function>
  explicit ForkedProcess(const Function& function) {
    int pipe_ends[2];
    if (::pipe(pipe_ends) != 0) std::abort();
    id_ = ::fork();
    if (id_ == 0) {
      ::close(pipe_ends[0]);
      ready_end() = pipe_ends[1];
      function();
      ::_exit(0);
    }
    ::close(pipe_ends[1]);
    char byte = 0;
    while (::read(pipe_ends[0], &byte, 1) < 0) {
    }
    ::close(pipe_ends[0]);
  }
  ~ForkedProcess() {
    if (!is_reaped_) kill(SIGKILL);
  }
  ForkedProcess(const ForkedProcess&) = delete;
  ForkedProcess& operator=(const ForkedProcess&) = delete;

  [[nodiscard]] pid_t id() const { return id_; }

  /// Sends a signal and returns the status from wait() when the child has ended.
  int kill(int signal) {
    ::kill(id_, signal);
    return wait();
  }
  int wait() {
    int status = 0;
    ::waitpid(id_, &status, 0);
    is_reaped_ = true;
    return status;
  }

  /// The next two are for the child.
  static void report_ready() { ::close(ready_end()); }
  [[noreturn]] static void wait_for_end() {
    while (true) ::pause();
  }

 private:
  static int& ready_end() {
    static int end = -1;
    return end;
  }

  pid_t id_ = -1;
  bool is_reaped_ = false;
};

/// Exit code of a child that lacks a permission or feature that the test needs.
constexpr int kForkedSkip = 77;

/// Runs the function in a child process and returns its result (the exit code); -1 if a signal
/// ended it.
template <typename Function>
int run_forked(const Function& function) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(function());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline pid_t id_of_dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

/// Drops root privileges, for tests of permissions. Whether this process runs as an ordinary user
/// afterwards.
inline bool drop_privileges() {
  constexpr uid_t kNobody = 65534;
  if (::geteuid() != 0) return true;
  return ::setgroups(0, nullptr) == 0 && ::setgid(kNobody) == 0 && ::setuid(kNobody) == 0;
}
