// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/run_tasks.hpp"
#include "pcavr/pipeline/task_graph.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {

/// Small recordings, and a script in place of the command: it writes the output that -o names, adds
/// a line to `calls`, and fails for recordings whose name contains "bad".
class TaskCase {
 public:
  TaskCase() {
    write("command",
          "#!/bin/sh\necho \"$1 $2\" >> '" + path("calls") +
              "'\n"
              "case \"$2\" in *bad*) echo 'pcavr: it is bad; make it good' >&2; exit 1;; "
              "esac\n"
              "while [ \"$1\" != -o ]; do shift; done\n"
              "mkdir -p \"$2\" && echo done > \"$2/file\"\n");
    std::filesystem::permissions(path("command"), std::filesystem::perms::owner_all);
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
  }
  /// A recording of one object, whose tool is at `x` [m].
  std::string record(const std::string& name, const std::string& x,
                     const std::string& mesh = "v 0 0 0\n") const {
    write(name + "/recording.yaml",
          "format: pcavr-recording/1\nobjects:\n  - {name: box, mesh: box.obj, mass: 1.0}\n"
          "tool: {radius: 0.01}\n");
    write(name + "/box.obj", mesh);
    write(name + "/tool.csv",
          "t,x,y,z,qx,qy,qz,qw\n0.0," + x + ",0,0,0,0,0,1\n0.1," + x + ",0,0,0,0,0,1\n");
    return path(name);
  }

  [[nodiscard]] Expected<TaskGraph> plan(const std::vector<std::string>& recordings) const {
    return make_task_graph({.recordings = recordings,
                            .chain = {TaskStage::build, TaskStage::replay},
                            .results = path("results")});
  }
  [[nodiscard]] Expected<TasksRun> run(const TaskGraph& graph) const {
    return run_tasks(graph, {.command = path("command"), .jobs = 2});
  }
  [[nodiscard]] std::ptrdiff_t calls() const {
    const Expected<std::string> text = read_file(path("calls"));
    return text ? std::ranges::count(*text, '\n') : 0;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace pcavr
