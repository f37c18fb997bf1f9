// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pcavr {
namespace {

constexpr int kLogMode = 0666;
constexpr int kNotStarted = 127;  // as shells have it
constexpr double kKilobyte = 1024.0;
/// Between two looks at a child: short against a task, long against a look.
constexpr std::chrono::milliseconds kPollInterval{2};

Error cannot_start(const std::filesystem::path& program, int failure) {
  return {.message = std::string("can't be started: ") + std::strerror(failure),
          .file = program.string(),
          .place = {},
          .hint = "close other programs, or use fewer --jobs"};
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// In the child, between fork and exec: async-signal-safe calls only, since the parent has threads.
[[noreturn]] void become(const char* program, char* const* words, pid_t parent, int log, int kept) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(kNotStarted);  // the parent has ended meanwhile
  const int none = ::open("/dev/null", O_RDONLY);
  ::dup2(none, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  if (kept >= 0) ::fcntl(kept, F_SETFD, 0);
  ::execv(program, words);
  ::_exit(kNotStarted);
}

}  // namespace

Expected<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                           const std::vector<std::string>& words,
                                           const std::filesystem::path& log, int kept) {
  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kLogMode);
  if (output < 0) {
    return Error{.message = std::string("can't be written: ") + std::strerror(errno),
                 .file = log.string()};
  }
  const std::string name = program.filename().string();
  std::vector<char*> arguments{const_cast<char*>(name.c_str())};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  const int failure = errno;
  if (process == 0) become(program.c_str(), arguments.data(), parent, output, kept);
  ::close(output);
  if (process < 0) return cannot_start(program, failure);
  return ChildProcess(process);
}

void ChildProcess::wait_for_end(const std::vector<ChildProcess>& children,
                                std::chrono::milliseconds timeout) {
  std::vector<pollfd> ends;
  for (const ChildProcess& child : children) {
    const auto end = static_cast<int>(::syscall(SYS_pidfd_open, child.process_, 0U));
    if (end >= 0) ends.push_back({.fd = end, .events = POLLIN, .revents = 0});
  }
  // Where the kernel has none of these (before 5.3), they are looked at in short intervals.
  const bool has_all = ends.size() == children.size();
  ::poll(ends.data(), ends.size(),
         static_cast<int>((has_all ? timeout : std::min(timeout, kPollInterval)).count()));
  for (const pollfd& end : ends) ::close(end.fd);
}

std::optional<ProcessEnd> ChildProcess::poll() const {
  int status = 0;
  rusage usage{};
  const pid_t ended = ::wait4(process_, &status, WNOHANG, &usage);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  ProcessEnd end;
  if (ended < 0) {
    end.exit_code = kNotStarted;
    return end;
  }
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  end.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  end.memory = kKilobyte * static_cast<double>(usage.ru_maxrss);
  return end;
}

}  // namespace pcavr
