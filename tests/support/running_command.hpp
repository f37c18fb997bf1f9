// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"

/// Empty where there is no such file yet.
inline std::string text_of(const std::filesystem::path& file) {
  const pcavr::Expected<std::string> text = pcavr::read_file(file);
  return text ? *text : std::string();
}

/// A running `pcavr` with its output in files.
class RunningCommand {
 public:
  RunningCommand(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                 const std::string& name)
      : output_(folder / (name + ".out")), errors_(folder / (name + ".err")) {
    std::vector<std::string> all{"pcavr"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& argument : all) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    if (std::freopen(output_.c_str(), "w", stdout) == nullptr ||
        std::freopen(errors_.c_str(), "w", stderr) == nullptr) {
      ::_exit(126);
    }
    ::execv(PCAVR_COMMAND, argv.data());
    ::_exit(127);
  }
  ~RunningCommand() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }
  RunningCommand(const RunningCommand&) = delete;
  RunningCommand& operator=(const RunningCommand&) = delete;

  void signal(int number) const { ::kill(pid_, number); }
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const { return text_of(output_); }
  std::string errors() const { return text_of(errors_); }
  /// Waits until it has printed `text` on standard error; false after a minute.
  bool has_said(const std::string& text) const { return appears_in(errors_, text); }
  /// The same of standard output.
  bool has_printed(const std::string& text) const { return appears_in(output_, text); }

 private:
  static bool appears_in(const std::filesystem::path& file, const std::string& text) {
    const auto is_there = [&] { return text_of(file).find(text) != std::string::npos; };
    for (int i = 0; i < 1200 && !is_there(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return is_there();
  }

  std::filesystem::path output_;
  std::filesystem::path errors_;
  pid_t pid_ = -1;
};
