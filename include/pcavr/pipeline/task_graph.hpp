// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"

namespace pcavr {

/// The commands that a plan consists of, in the order of the chain; `survey` and `fuse` are added
/// where scenes are built by tiles, `pool` by gather_results.
enum class TaskStage { survey, fuse, build, identify, replay, evaluate, pool };
[[nodiscard]] std::string_view name_of(TaskStage stage);

/// A file or folder of an input, as it was when the plan was made.
struct PlannedInput {
  std::filesystem::path path;  ///< absolute
  std::string content = {};    ///< SHA-256 of names and bytes
  std::string listing = {};    ///< SHA-256 of names, sizes and times of the last change
};

/// A recording of a plan.
struct PlannedRecording {
  std::string name;                        ///< SUPPORT/FOLDER, also the folder of its results
  std::string support;                     ///< what its objects stand on
  PlannedInput files;                      ///< without truth/
  std::optional<PlannedInput> truth = {};  ///< truth/, which evaluation alone reads
  std::vector<std::string> objects = {};   ///< the movable ones
  std::size_t frames = 0;                  ///< images
  std::size_t samples = 0;                 ///< of tool and force
};

/// One of several configurations under which each recording is replayed.
struct ReplaySetting {
  std::string name;
  std::optional<PlannedInput> configuration = {};  ///< none: the defaults
};

/// What a task is expected to need, by the model of docs/files.md.
struct TaskEstimate {
  double seconds = 0.0;  ///< of one core
  double memory = 0.0;   ///< [bytes]
};

/// One command on one recording.
struct Task {
  std::string name;  ///< RECORDING/STAGE, with the setting's name where there are several
  TaskStage stage = TaskStage::build;
  std::vector<std::size_t> recordings = {};  ///< indices; one, except where runs are pooled
  std::optional<std::size_t> setting = {};   ///< index
  std::vector<std::size_t> after = {};       ///< indices of earlier tasks whose outputs it reads
  std::vector<std::string> command = {};     ///< the words after `pcavr`
  std::vector<std::filesystem::path> outputs = {};  ///< absolute
  TaskEstimate estimate = {};
};

/// Tasks in an order in which they can be run.
struct TaskGraph {
  std::string version;                             ///< of pcavr
  std::filesystem::path results;                   ///< absolute
  std::optional<PlannedInput> configuration = {};  ///< of all tasks without a setting
  std::vector<PlannedRecording> recordings = {};
  std::vector<ReplaySetting> settings = {};  ///< at least one
  std::vector<Task> tasks = {};
};

struct TaskGraphRequest {
  std::vector<std::string> recordings;  ///< folders
  std::vector<TaskStage> chain;         ///< ascending, without repetition
  std::filesystem::path results;
  std::string configuration = {};  ///< options file, may be empty
  /// Name and options file of each setting; empty: one, with `configuration`.
  std::vector<std::pair<std::string, std::string>> settings = {};
  std::string support = {};  ///< of all recordings; empty: the folder that each lies in
  double tile_size = 0.0;    ///< scenes of recordings with images are built by tiles [m]; 0: not
  std::size_t parts = 1;     ///< tasks of each scene's tiles
};

/// Reads all recordings, hashes their files and makes the graph; the stages follow each other, each
/// with its recordings in their order. Errors: a recording that is missing or faulty; one that is
/// given twice, also as a copy; two objects of one name with different CAD files or masses; a chain
/// with a stage whose input no other makes. Nothing is written.
[[nodiscard]] Expected<TaskGraph> make_task_graph(const TaskGraphRequest& request,
                                                  const Observer& observer = {});

/// "build,identify,replay,evaluate" as stages; an Error for another word, or another order.
[[nodiscard]] Expected<std::vector<TaskStage>> parse_chain(const std::string& text);

/// The plan's file, `pcavr-plan/1` (JSON). Reading is strict, and checks that the tasks' indices
/// are those of earlier tasks.
[[nodiscard]] std::string format_task_graph(const TaskGraph& graph);
[[nodiscard]] Expected<TaskGraph> read_task_graph(const std::filesystem::path& file);

}  // namespace pcavr
