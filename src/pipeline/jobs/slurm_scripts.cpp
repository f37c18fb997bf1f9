// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/slurm_scripts.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/core.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"

#include "child_process.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

// Requests relative to the estimates, which are of one machine: a job that exceeds one is ended.
constexpr double kTimeMargin = 4.0;
constexpr double kMemoryMargin = 2.0;
constexpr double kMinMinutes = 5.0;
constexpr double kMinMegabytes = 256.0;
constexpr double kMegabyte = 1e6;
constexpr double kMinute = 60.0;  // [s]

/// Tasks of one stage and setting, which follow each other, one for each recording.
struct TaskArray {
  std::string name;
  std::size_t first = 0;
  std::size_t count = 0;
  TaskEstimate maximum = {};
  std::set<std::size_t> after = {};  ///< indices of arrays
  /// Whether each task needs the one at its place in these arrays, and no other of them.
  bool is_one_by_one = true;
};

bool is_same_array(const Task& a, const Task& b) {
  return a.stage == b.stage && a.setting == b.setting;
}

std::string array_name(const TaskGraph& graph, const Task& task) {
  std::string name(name_of(task.stage));
  if (task.setting && graph.settings.size() > 1) name += '-' + graph.settings[*task.setting].name;
  return name;
}

std::vector<TaskArray> arrays_of(const TaskGraph& graph) {
  std::vector<TaskArray> arrays;
  std::vector<std::size_t> array_of;  // by task
  for (std::size_t i = 0; i < graph.tasks.size(); ++i) {
    const Task& task = graph.tasks[i];
    if (i == 0 || !is_same_array(graph.tasks[i - 1], task)) {
      arrays.push_back({.name = array_name(graph, task), .first = i});
    }
    TaskArray& array = arrays.back();
    for (const std::size_t before : task.after) {
      array.after.insert(array_of[before]);
      array.is_one_by_one &= before - arrays[array_of[before]].first == array.count;
    }
    ++array.count;
    array.maximum.seconds = std::max(array.maximum.seconds, task.estimate.seconds);
    array.maximum.memory = std::max(array.maximum.memory, task.estimate.memory);
    array_of.push_back(arrays.size() - 1);
  }
  for (TaskArray& array : arrays) {
    for (const std::size_t before : array.after)
      array.is_one_by_one &= arrays[before].count == array.count;
  }
  return arrays;
}

/// One word for a POSIX shell.
std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + '\'';
}

std::string array_script(const TaskArray& array, const fs::path& plan, const fs::path& command) {
  const double minutes = std::max(kMinMinutes, kTimeMargin * array.maximum.seconds / kMinute);
  const double megabytes =
      std::max(kMinMegabytes, kMemoryMargin * array.maximum.memory / kMegabyte);
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=pcavr-{}\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --cpus-per-task=1\n"
      "#SBATCH --mem={:.0f}M\n"
      "#SBATCH --time={:.0f}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output={}-%a.log\n"
      "exec {} run {} --task $(({} + SLURM_ARRAY_TASK_ID)) --threads 1\n",
      array.name, array.count - 1, std::ceil(megabytes), std::ceil(minutes), array.name,
      shell_word(command.string()), shell_word(plan.string()), array.first);
}

/// The variable of a job's number: letters, digits and '_' alone.
std::string variable_of(std::size_t array) { return fmt::format("job_{}", array); }

std::string submit_script(const std::vector<TaskArray>& arrays) {
  std::string text = "#!/bin/sh\nset -eu\ncd \"$(dirname \"$0\")\"\n";
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    std::string dependency;
    for (const std::size_t before : arrays[i].after) {
      dependency +=
          fmt::format("{}{}:${{{}%%;*}}", dependency.empty() ? "" : ",",
                      arrays[i].is_one_by_one ? "aftercorr" : "afterany", variable_of(before));
    }
    const std::string option =
        dependency.empty()
            ? ""
            : fmt::format(" --dependency=\"{}\" --kill-on-invalid-dep=yes", dependency);
    text +=
        fmt::format("{}=$(sbatch --parsable{} {}.sh)\n", variable_of(i), option, arrays[i].name);
    text += fmt::format("echo \"{}: job ${{{}%%;*}}\"\n", arrays[i].name, variable_of(i));
  }
  return text;
}

bool has_sbatch() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((fs::path(folder) / "sbatch").c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace

std::vector<SlurmScript> slurm_scripts(const TaskGraph& graph, const fs::path& plan,
                                       const fs::path& command) {
  const std::vector<TaskArray> arrays = arrays_of(graph);
  std::vector<SlurmScript> scripts;
  for (const TaskArray& array : arrays)
    scripts.push_back({array.name + ".sh", array_script(array, plan, command)});
  scripts.push_back({kSubmitScript, submit_script(arrays)});
  return scripts;
}

Expected<bool> submit_to_slurm(const std::vector<SlurmScript>& scripts, const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return Error{.message = "can't be created: " + code.message(), .file = folder.string()};
  for (const SlurmScript& script : scripts) {
    const Expected<void> written = write_file(folder / script.name, script.text);
    if (!written) return written.error();
  }
  if (!has_sbatch()) return false;
  const fs::path log = folder / "submit.log";
  const Expected<ChildProcess> child =
      ChildProcess::start("/bin/sh", {(folder / kSubmitScript).string()}, log, -1);
  if (!child) return child.error();
  std::optional<ProcessEnd> end;
  while (!(end = child->poll())) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (end->exit_code == 0 && end->signal == 0) return true;
  return Error{.message = "sbatch failed",
               .file = log.string(),
               .place = {},
               .hint = "read this log; jobs that were submitted before are in it"};
}

}  // namespace pcavr
