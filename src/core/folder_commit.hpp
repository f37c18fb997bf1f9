// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "pcavr/core/output.hpp"

#include "core/commit_hooks.hpp"

namespace pcavr {

/// A folder of new content, complete, that takes the place of a target.
struct FolderCommit {
  std::filesystem::path partial;
  std::filesystem::path target;
  /// Called just before a target that is there and not empty would be replaced.
  std::function<Expected<void>()> check_replaceable;
};

/// Files and folders, and the folder's own entries, are on the disk afterwards.
[[nodiscard]] Expected<void> sync_tree(const std::filesystem::path& folder);
/// The entries of a folder; best effort.
void sync_folder(const std::filesystem::path& folder);

/// The partial folder lies beside the target. Exchanges the two at once; where the file system
/// can't, the target is moved aside first. A crash in between is repaired by recover_beside().
[[nodiscard]] Expected<void> commit_beside(const FolderCommit& commit, const CommitHooks& hooks);
/// The partial folder lies within the target, which itself stays. The old entries are moved aside,
/// their manifest first; then the new ones are moved in, their manifest last: a reader finds a
/// manifest only where all else is there. A crash in between is repaired by recover_inside().
[[nodiscard]] Expected<void> commit_inside(const FolderCommit& commit, const CommitHooks& hooks);

/// Removes what dead processes left for this target. What one of them had moved aside is moved
/// back, or where all of the new content is there, replaced by it.
void recover_beside(const std::filesystem::path& target);
void recover_inside(const std::filesystem::path& target);

}  // namespace pcavr
