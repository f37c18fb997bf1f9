// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/run_tasks.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <sstream>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"

#include "child_process.hpp"
#include "task_lock.hpp"
#include "task_record.hpp"
#include "task_state.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

/// Between two tries of a task that another process has: each is work of a shared disk.
constexpr std::chrono::milliseconds kBusyInterval{200};

struct RunningTask {
  std::size_t index;
  std::string key;
  TaskLock lock;
  ChildProcess child;
  Clock::time_point start;
};

/// The command's error line in its log, without the program's name; else its last line.
std::string failure_line(const fs::path& log) {
  const Expected<std::string> text = read_file(log);
  std::istringstream lines(text ? *text : std::string());
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("pcavr: ")) return line.substr(std::strlen("pcavr: "));
    if (!line.empty()) last = line;
  }
  return last;
}

std::string failure_reason(const ProcessEnd& end, const fs::path& log) {
  if (end.signal != 0)
    return fmt::format("ended by signal {} ({})", end.signal, ::strsignal(end.signal));
  const std::string line = failure_line(log);
  return line.empty() ? fmt::format("exit code {}, see {}", end.exit_code, log.string()) : line;
}

class TaskRunner {
 public:
  TaskRunner(const TaskGraph& graph, const RunTasksOptions& options, const Observer& observer)
      : graph_(graph),
        options_(options),
        observer_(observer),
        states_(graph.tasks.size()),
        is_pending_(graph.tasks.size(), !options.only),
        busy_until_(graph.tasks.size()) {}

  Expected<TasksRun> run() {
    if (options_.only) {
      const Expected<void> prepared = prepare_only(*options_.only);
      if (!prepared) return prepared.error();
    }
    total_ = std::ranges::count(is_pending_, true);
    while (std::ranges::count(is_pending_, true) > 0 || !running_.empty()) {
      const bool has_started = start_ready();
      const bool has_collected = collect_ended();
      if (!has_started && !has_collected) wait_for_change();
    }
    return TasksRun{std::move(states_), ran_, were_done_};
  }

 private:
  /// Until a child has ended, or a task that another process has may be tried again.
  void wait_for_change() const {
    std::vector<ChildProcess> children;
    for (const RunningTask& one : running_) children.push_back(one.child);
    ChildProcess::wait_for_end(children, kBusyInterval);
  }

  /// The states of the tasks before it, by their records.
  Expected<void> prepare_only(std::size_t index) {
    states_ = states_before(graph_, index);
    is_pending_[index] = true;
    for (const std::size_t before : graph_.tasks[index].after) {
      if (states_[before].state == TaskState::done) continue;
      return Error{.message = fmt::format("needs task {}, {}, which is not done", before,
                                          graph_.tasks[before].name),
                   .file = graph_.tasks[index].name,
                   .place = {},
                   .hint = "run that first; pcavr status states what became of it"};
    }
    return {};
  }

  /// Starts what can be started; whether any task's state has changed.
  bool start_ready() {
    bool has_changed = false;
    for (std::size_t i = 0; i < graph_.tasks.size(); ++i) {
      if (running_.size() >= static_cast<std::size_t>(options_.jobs)) break;
      if (!is_pending_[i] || Clock::now() < busy_until_[i]) continue;
      const std::optional<TaskStatus> blocked = blocked_status(graph_, graph_.tasks[i], states_);
      if (blocked && blocked->state == TaskState::waiting) continue;
      has_changed |= blocked ? finish(i, *blocked) : try_start(i);
    }
    return has_changed;
  }

  /// False where another process has the task.
  bool try_start(std::size_t i) {
    const Task& task = graph_.tasks[i];
    std::error_code ignored;  // a folder that is missing shows at the lock
    fs::create_directories(task_file(graph_, task, ".lock").parent_path(), ignored);
    Expected<std::optional<TaskLock>> lock =
        TaskLock::try_acquire(task_file(graph_, task, ".lock"));
    if (!lock) return finish(i, failed(lock.error().to_string()));
    if (!*lock) {
      busy_until_[i] = Clock::now() + kBusyInterval;
      return false;
    }
    const std::string key = key_of(graph_, task, states_);
    const TaskStatus recorded = recorded_status(graph_, task, key);
    const bool was_busy = busy_until_[i] != Clock::time_point();
    const bool is_settled =
        recorded.state == TaskState::done || (recorded.state == TaskState::failed && was_busy);
    if (is_settled) {
      if (recorded.state == TaskState::done) ++were_done_;
      return finish(i, recorded);
    }
    return start(i, key, std::move(**lock));
  }

  bool start(std::size_t i, const std::string& key, TaskLock lock) {
    const Task& task = graph_.tasks[i];
    // Removed first, so that no record is beside outputs that it does not describe.
    std::error_code ignored;
    fs::remove(task_file(graph_, task, ".json"), ignored);
    std::vector<std::string> words = task.command;
    words.insert(words.end(), {"--force", "--threads", std::to_string(options_.threads)});
    Expected<ChildProcess> child = ChildProcess::start(
        options_.command, words, task_file(graph_, task, ".log"), lock.descriptor());
    if (!child) return finish(i, failed(child.error().to_string()));
    is_pending_[i] = false;
    states_[i].state = TaskState::running;
    running_.push_back({i, key, std::move(lock), *child, Clock::now()});
    return true;
  }

  bool collect_ended() {
    bool has_changed = false;
    for (std::size_t k = 0; k < running_.size();) {
      const std::optional<ProcessEnd> end = running_[k].child.poll();
      if (!end) {
        ++k;
        continue;
      }
      ++ran_;
      has_changed |= finish(running_[k].index, settle(running_[k], *end));
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(k));  // releases the lock
    }
    return has_changed;
  }

  /// Writes the record of a task that has ended.
  TaskStatus settle(const RunningTask& one, const ProcessEnd& end) {
    const Task& task = graph_.tasks[one.index];
    TaskRecord record{.key = one.key,
                      .is_done = end.exit_code == 0 && end.signal == 0,
                      .seconds = std::chrono::duration<double>(Clock::now() - one.start).count(),
                      .cpu_seconds = end.cpu_seconds,
                      .memory = end.memory};
    if (!record.is_done) record.reason = failure_reason(end, task_file(graph_, task, ".log"));
    for (std::size_t k = 0; record.is_done && k < task.outputs.size(); ++k) {
      const Expected<InputContent> output = input_content(task.outputs[k]);
      record.is_done = output.has_value();
      if (output) record.outputs.push_back(*output);
      if (!output) record.reason = output.error().to_string();
    }
    const Expected<void> written = write_task_record(record, task_file(graph_, task, ".json"));
    if (!written) return failed(written.error().to_string());
    if (!record.is_done) return failed(record.reason);
    return {
        .state = TaskState::done, .seconds = record.seconds, .content = content_of_outputs(record)};
  }

  static TaskStatus failed(const std::string& reason) {
    return {.state = TaskState::failed, .reason = reason};
  }

  bool finish(std::size_t i, const TaskStatus& status) {
    is_pending_[i] = false;
    states_[i] = status;
    if (status.state != TaskState::done) {
      observer_.on_warning(
          fmt::format("{} {}: {}", graph_.tasks[i].name, name_of(status.state), status.reason));
    }
    observer_.on_progress("running tasks", ++finished_, static_cast<std::size_t>(total_));
    return true;
  }

  const TaskGraph& graph_;
  const RunTasksOptions& options_;
  const Observer& observer_;
  std::vector<TaskStatus> states_;
  std::vector<bool> is_pending_;
  std::vector<Clock::time_point> busy_until_;  ///< where another process had it; else the epoch
  std::vector<RunningTask> running_ = {};
  std::ptrdiff_t total_ = 0;
  std::size_t finished_ = 0;
  std::size_t ran_ = 0;
  std::size_t were_done_ = 0;
};

}  // namespace

Expected<TasksRun> run_tasks(const TaskGraph& graph, const RunTasksOptions& options,
                             const Observer& observer) {
  PCAVR_REQUIRE(options.jobs >= 1 && options.threads >= 1);
  PCAVR_REQUIRE(!options.only || *options.only < graph.tasks.size());
  return TaskRunner(graph, options, observer).run();
}

}  // namespace pcavr
