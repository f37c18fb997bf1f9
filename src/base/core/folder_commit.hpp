// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "pcavr/base/core/output.hpp"

#include "base/core/commit_hooks.hpp"

namespace pcavr {

/// A complete folder of new content that replaces a target.
struct FolderCommit {
  std::filesystem::path partial;
  std::filesystem::path target;
  /// Called just before an existing target that is not empty would be replaced.
  std::function<Expected<void>()> check_replaceable;
};

/// Flushes the files and folders, and the folder's own entries, to the disk (fsync).
[[nodiscard]] Expected<void> sync_tree(const std::filesystem::path& folder);
/// Flushes the entries of a folder; best effort.
void sync_folder(const std::filesystem::path& folder);

/// The partial folder is a sibling of the target. Exchanges the two atomically; where the file
/// system can't, the target is moved aside first. recover_sibling() repairs a crash in between.
[[nodiscard]] Expected<void> commit_sibling(const FolderCommit& commit, const CommitHooks& hooks);
/// The partial folder is inside the target, which itself stays. The old entries are moved aside,
/// their manifest first; then the new ones are moved in, their manifest last: a reader finds a
/// manifest only where everything else is complete. recover_inside() repairs a crash in between.
[[nodiscard]] Expected<void> commit_inside(const FolderCommit& commit, const CommitHooks& hooks);

/// Crash recovery: removes what dead processes left for this target. Content that one of them had
/// moved aside is moved back, or replaced by the new content where that is complete.
void recover_sibling(const std::filesystem::path& target);
void recover_inside(const std::filesystem::path& target);

}  // namespace pcavr
