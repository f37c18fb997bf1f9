// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

struct CommitHooks;

/// What a folder that pcavr wrote holds, known by its manifest: recording.yaml, scene.yaml,
/// run.yaml, report.json.
enum class OutputKind { recording, scene, run, report };

struct OutputFolderOptions {
  std::optional<OutputKind> kind = {};  ///< what will be written
  /// Replaces a folder that holds an output of this kind and nothing else. Needs `kind`.
  bool replace = false;
};

/// A folder that appears whole or not at all: it is filled under a temporary name, and put in its
/// place by commit(). Destroyed without commit(), it leaves nothing; nor does a process that ends
/// by a signal (install_signal_cleanup). What a killed process left is removed by the next one that
/// writes the same target.
///
/// The temporary name is beside the target; within it where the target is a mount point, the
/// current folder, or in a folder that can't be written to.
class OutputFolder {
 public:
  /// Symbolic links in `target` are followed, absent parent folders are made. Fails where the
  /// target is there and is neither an empty folder nor what `options` allow to replace, and where
  /// it can't be written to.
  [[nodiscard]] static Expected<OutputFolder> create(const std::filesystem::path& target,
                                                     const OutputFolderOptions& options = {});

  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  ~OutputFolder();

  /// Where to write before commit().
  [[nodiscard]] const std::filesystem::path& path() const;

  /// Brings the content to the disk and puts it in its place, atomically where it is beside the
  /// target; within the target its manifest is moved last. A crash at any instant leaves the old or
  /// the new content, at the latest after the next create(). Call once, at the end.
  [[nodiscard]] Expected<void> commit();
  /// The same, interrupted between its steps: for tests (src/core/commit_hooks.hpp).
  [[nodiscard]] Expected<void> commit(const CommitHooks& hooks);

 private:
  struct State;
  explicit OutputFolder(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// Writes the whole file under a temporary name beside `target`, then renames it. A full disk or a
/// folder that can't be written to is an Error, and leaves nothing behind. For files within an
/// OutputFolder; OutputFile is for those that a person names.
[[nodiscard]] Expected<void> write_file(const std::filesystem::path& target,
                                        std::string_view content);

/// Reads a whole file.
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path);

}  // namespace pcavr
