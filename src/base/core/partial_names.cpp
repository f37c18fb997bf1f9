// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/partial_names.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <sstream>

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "pcavr/base/core/content_id.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::pair<PartialState, std::string_view>, 3> kStates{
    {{PartialState::partial, "partial-"},
     {PartialState::moving, "moving-"},
     {PartialState::old, "old-"}}};

constexpr char kInsidePrefix[] = ".pcavr-in-place.";

/// Largest length of a name [bytes]. A file name has at most 255; ".", ".partial-", a process id
/// and an extension are added.
constexpr std::size_t kMaxName = 150;

/// [s] On a file system without locks (some network ones) the process may be on another machine:
/// it is considered dead when it wrote nothing for a day.
constexpr double kMaxIdleTime = 86400.0;

/// [s] Two clocks are compared, the process's start (in ticks of 10 ms since the boot) and the
/// file's birth: a clock adjustment must not make a live owner appear to be younger than its file.
constexpr double kClockMargin = 2.0;

/// FNV-1a, 64 bit: the same text for the same name in every build.
std::string hash_of(const std::string& name) {
  return content_id(fnv1a(std::as_bytes(std::span(name))));
}

double seconds(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double clock_now(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return seconds(now);
}

/// The time at which the process was started [s since 1970]; nothing where it does not exist or is
/// a zombie.
std::optional<double> process_start(long process) {
  if (::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) return std::nullopt;
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  // The name, in parentheses, may hold anything; the state is the third field, the start the 22nd.
  const std::size_t end = text.rfind(')');
  if (end == text.npos) return 0.0;  // no /proc: it is alive, its start is unknown
  std::istringstream fields(text.substr(end + 1));
  std::string field;
  fields >> field;
  if (field == "Z" || field == "X") return std::nullopt;
  for (int i = 4; i <= 22; ++i) fields >> field;
  const double ticks = std::strtod(field.c_str(), nullptr);
  const double boot = clock_now(CLOCK_REALTIME) - clock_now(CLOCK_BOOTTIME);
  return boot + ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// [s since 1970] Birth time, or the last change where the file system has no birth time.
double birth_of(int file) {
  struct statx status {};
  if (::statx(file, "", AT_EMPTY_PATH, STATX_BTIME | STATX_MTIME, &status) != 0) return 0.0;
  const statx_timestamp& time =
      (status.stx_mask & STATX_BTIME) != 0 ? status.stx_btime : status.stx_mtime;
  return static_cast<double>(time.tv_sec) + 1e-9 * time.tv_nsec;
}

double idle_time(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0) return 0.0;
  return clock_now(CLOCK_REALTIME) - seconds(status.st_mtim);
}

FileDescriptor open_for_lock(const fs::path& path) {
  return FileDescriptor(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW));
}

bool is_in_use(const fs::path& path, long process) {
  const FileDescriptor file = open_for_lock(path);
  if (!file.is_open()) return true;  // another user's
  const bool is_locked = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
  if (!is_locked && errno == EWOULDBLOCK) return true;
  // The lock is free: its process is dead, or has only just created the file; this process would
  // hold the lock.
  if (process != ::getpid()) {
    const std::optional<double> start = process_start(process);
    if (start && *start <= birth_of(file.get()) + kClockMargin) return true;
  }
  return !is_locked && idle_time(file.get()) < kMaxIdleTime;
}

}  // namespace

PartialNames::PartialNames(fs::path folder, std::string prefix, std::string extension)
    : folder_(std::move(folder)), prefix_(std::move(prefix)), extension_(std::move(extension)) {}

PartialNames PartialNames::sibling_of(const fs::path& target, std::string extension) {
  const std::string name = target.filename().string();
  const std::string shown = name.size() > kMaxName ? hash_of(name) : name;
  return {target.parent_path(), "." + shown + ".", std::move(extension)};
}

PartialNames PartialNames::inside(const fs::path& target) { return {target, kInsidePrefix, {}}; }

bool PartialNames::is_inside_name(std::string_view name) {
  return name.substr(0, sizeof kInsidePrefix - 1) == kInsidePrefix;
}

fs::path PartialNames::path(PartialState state) const {
  const auto* known = std::find_if(kStates.begin(), kStates.end(),
                                   [&](const auto& one) { return one.first == state; });
  return folder_ / (prefix_ + std::string(known->second) + std::to_string(::getpid()) + extension_);
}

fs::path PartialNames::Found::path(PartialState state) const {
  for (const auto& [one, path] : paths) {
    if (one == state) return path;
  }
  return {};
}

std::vector<PartialNames::Found> PartialNames::find_abandoned() const {
  std::map<long, Found> found;
  std::error_code code;
  for (fs::directory_iterator entry(folder_, code), end; !code && entry != end;
       entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    if (name.compare(0, prefix_.size(), prefix_) != 0) continue;
    const std::string_view rest = std::string_view(name).substr(prefix_.size());
    for (const auto& [state, word] : kStates) {
      if (rest.substr(0, word.size()) != word) continue;
      const std::string_view number = rest.substr(word.size());
      long process = 0;
      const auto [last, fault] =
          std::from_chars(number.data(), number.data() + number.size(), process);
      const std::string_view end_of_name(last, number.data() + number.size());
      if (fault != std::errc() || process <= 0 || end_of_name != extension_) continue;
      found[process].process = process;
      found[process].paths.emplace_back(state, entry->path());
    }
  }
  std::vector<Found> abandoned;
  for (auto& entry : found) {
    Found& one = entry.second;
    const bool is_live = std::any_of(one.paths.begin(), one.paths.end(), [&](const auto& path) {
      return is_in_use(path.second, one.process);
    });
    if (!is_live) abandoned.push_back(std::move(one));
  }
  return abandoned;
}

FileDescriptor acquire_lock(const fs::path& path) {
  FileDescriptor file = open_for_lock(path);
  if (!file.is_open()) return file;
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return {};
  return file;
}

}  // namespace pcavr
