// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct CommitHooks;

/// Kind of content of a folder that pcavr wrote, identified by its manifest: recording.yaml,
/// scene.yaml, run.yaml, report.json.
enum class OutputKind { recording, scene, run, report };

struct OutputFolderOptions {
  std::optional<OutputKind> kind = {};  ///< what will be written
  /// Replaces a folder that contains an output of this kind and nothing else. Requires `kind`.
  bool replace = false;
};

/// A folder that is written atomically: it is filled under a temporary name, and moved into place
/// by commit(). Destroyed without commit(), it leaves nothing; nor does a process that ends by a
/// signal (install_signal_cleanup). What a killed process left is removed by the next one that
/// writes the same target.
///
/// The temporary folder is a sibling of the target; it is inside the target where that is a mount
/// point, the current folder, or in a folder that can't be written to.
class OutputFolder {
 public:
  /// Follows symbolic links in `target` and creates missing parent folders. Fails where the target
  /// exists and is neither an empty folder nor what `options` allow to replace, and where it can't
  /// be written to.
  [[nodiscard]] static Expected<OutputFolder> create(const std::filesystem::path& target,
                                                     const OutputFolderOptions& options = {});

  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  ~OutputFolder();

  /// The folder to write to before commit().
  [[nodiscard]] const std::filesystem::path& path() const;

  /// Flushes the content to the disk (fsync) and moves it into place: atomically from a sibling,
  /// entry by entry with the manifest last from inside the target. After a crash at any instant
  /// the target has the old or the new content, at the latest after the next create(). Call once,
  /// at the end.
  [[nodiscard]] Expected<void> commit();
  /// The same with hooks between its steps, for crash tests (src/base/core/commit_hooks.hpp).
  [[nodiscard]] Expected<void> commit(const CommitHooks& hooks);

 private:
  struct State;
  explicit OutputFolder(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// Writes a file atomically: under a temporary name in the same folder, then renames it. A full
/// disk or a folder that can't be written to is an Error, and leaves nothing behind. For files
/// inside an OutputFolder; OutputFile is for files that the user names.
[[nodiscard]] Expected<void> write_file(const std::filesystem::path& target,
                                        std::string_view content);

/// Reads a file into memory.
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path);

}  // namespace pcavr
