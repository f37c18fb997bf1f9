// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/folder_commit.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "base/core/file_content.hpp"
#include "base/core/file_descriptor.hpp"
#include "base/core/output_error.hpp"
#include "base/core/output_kind.hpp"
#include "base/core/partial_names.hpp"
#include "base/core/partial_registry.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

bool path_exists(const fs::path& path) {
  std::error_code code;
  return fs::symlink_status(path, code).type() != fs::file_type::not_found;
}

bool is_empty_or_absent(const fs::path& folder) {
  std::error_code code;
  return !path_exists(folder) || (fs::is_empty(folder, code) && !code);
}

bool exchange(const fs::path& a, const fs::path& b) {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

/// The folder's entries, without those that are never moved; manifests at the end.
std::vector<fs::path> movable_entries(const fs::path& folder, std::error_code& code) {
  std::vector<fs::path> names;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    const fs::path name = entry->path().filename();
    if (!is_ignored_entry(name.string())) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(),
                        [](const fs::path& name) { return !is_manifest_name(name.string()); });
  return names;
}

/// A folder of an overlay's lower layer (a container's image) can't be renamed, and one that was
/// moved in part exists on both sides: their entries are moved one by one.
void move_entry(const fs::path& name, const fs::path& from, const fs::path& to,
                const CommitHooks& hooks, std::error_code& code) {
  if (code) return;
  hooks.before_step("move an entry");
  fs::rename(from / name, to / name, code);
  const bool must_move_entries = code == std::errc::cross_device_link ||
                                 code == std::errc::directory_not_empty ||
                                 code == std::errc::file_exists;
  std::error_code ignored;
  if (!must_move_entries || !fs::is_directory(fs::symlink_status(from / name, ignored))) return;
  fs::create_directory(to / name, code);
  std::vector<fs::path> names;
  for (fs::directory_iterator entry(from / name, code), end; !code && entry != end;
       entry.increment(code)) {
    names.push_back(entry->path().filename());
  }
  for (const fs::path& inner : names) move_entry(inner, from / name, to / name, hooks, code);
  if (!code) fs::remove(from / name, code);
}

/// Moves the target's entries to a folder inside it, the manifest first.
void move_out(const fs::path& from, const fs::path& to, const CommitHooks& hooks,
              std::error_code& code) {
  std::vector<fs::path> names = movable_entries(from, code);
  std::reverse(names.begin(), names.end());
  for (const fs::path& name : names) move_entry(name, from, to, hooks, code);
}

/// The other direction: the manifest last, after everything else is flushed to the disk.
void move_in(const fs::path& from, const fs::path& to, const CommitHooks& hooks,
             std::error_code& code) {
  for (const fs::path& name : movable_entries(from, code)) {
    if (is_manifest_name(name.string())) sync_folder(to);
    move_entry(name, from, to, hooks, code);
  }
  sync_folder(to);
}

/// Moves the target aside and the new folder into place. Without an exchange there is an instant
/// at which neither is there.
std::error_code replace_by_renames(const FolderCommit& commit, const fs::path& aside,
                                   const CommitHooks& hooks) {
  std::error_code code;
  hooks.before_step("move the old folder aside");
  fs::rename(commit.target, aside, code);
  if (code) return code;
  hooks.before_step("move the new folder in");
  fs::rename(commit.partial, commit.target, code);
  if (!code) return code;
  std::error_code ignored;
  fs::rename(aside, commit.target, ignored);
  return code;
}

/// Moves the new content into place, with the registry's lock held. Returns the path of the old
/// content afterwards: an empty path if there was none, nullopt where the target can't be renamed.
Expected<std::optional<fs::path>> put_in_place(const FolderCommit& commit,
                                               const CommitHooks& hooks) {
  std::error_code code;
  if (is_empty_or_absent(commit.target)) {
    hooks.before_step("rename");
    fs::rename(commit.partial, commit.target, code);
    if (code) return can_not_write(commit.target, code);
    return std::optional(fs::path());
  }
  if (const auto replaceable = commit.check_replaceable(); !replaceable) {
    return replaceable.error();
  }
  // The lock prevents other processes from taking the old content for one that a dead process left.
  const FileDescriptor lock = acquire_lock(commit.target);
  hooks.before_step("exchange");
  if (hooks.can_exchange && exchange(commit.partial, commit.target)) {
    return std::optional(commit.partial);
  }
  const fs::path aside = PartialNames::sibling_of(commit.target).path(PartialState::old);
  code = replace_by_renames(commit, aside, hooks);
  if (code == std::errc::cross_device_link) return std::optional<fs::path>();
  if (code) return can_not_write(commit.target, code);
  return std::optional(aside);
}

/// Rolls back what move_into_place() has begun, as far as possible; what can't be moved stays, and
/// recover_inside() finds it.
void move_back(const FolderCommit& commit, const fs::path& moving, const fs::path& old) {
  std::error_code code;
  if (path_exists(old)) {
    move_out(commit.target, commit.partial, {}, code);
    if (!code) move_in(old, commit.target, {}, code);
  } else {
    move_in(moving, commit.target, {}, code);
  }
  // These remove the folders only where they are empty.
  fs::remove(old, code);
  fs::remove(moving, code);
}

std::error_code move_into_place(const FolderCommit& commit, const fs::path& moving,
                                const fs::path& old, const CommitHooks& hooks) {
  std::error_code code;
  hooks.before_step("make the folder for the old content");
  fs::create_directory(moving, code);
  if (!code) move_out(commit.target, moving, hooks, code);
  hooks.before_step("mark the old content as complete");
  if (!code) fs::rename(moving, old, code);
  if (!code) move_in(commit.partial, commit.target, hooks, code);
  if (code) move_back(commit, moving, old);
  return code;
}

bool holds_manifest(const fs::path& folder) {
  std::error_code code;
  const std::vector<fs::path> names = movable_entries(folder, code);
  return !names.empty() && is_manifest_name(names.back().string());
}

/// Completes or rolls back a commit_inside() that a dead process has begun.
std::error_code repair_inside(const PartialNames::Found& found, const fs::path& target) {
  const fs::path partial = found.path(PartialState::partial);
  const fs::path moving = found.path(PartialState::moving);
  const fs::path old = found.path(PartialState::old);
  std::error_code code;
  if (!moving.empty()) {
    move_in(moving, target, {}, code);  // the old content was being moved out
  } else if (!old.empty() && !partial.empty()) {
    move_in(partial, target, {}, code);  // the new content was being moved in
  } else if (!old.empty() && !holds_manifest(target)) {
    move_in(old, target, {}, code);  // the new content is lost
  }
  return code;
}

/// Moves the new content in where the target turns out not to be renamable, such as a folder of an
/// overlay's lower layer.
Expected<void> move_within(const FolderCommit& commit, const CommitHooks& hooks) {
  const fs::path within = PartialNames::inside(commit.target).path(PartialState::partial);
  PartialRegistry& registry = PartialRegistry::instance();
  std::error_code code;
  hooks.before_step("move the new folder within the old one");
  registry.add(within);
  fs::rename(commit.partial, within, code);
  if (code) return can_not_write(commit.target, code);
  const Expected<void> committed =
      commit_inside({within, commit.target, commit.check_replaceable}, hooks);
  if (!committed) fs::rename(within, commit.partial, code);
  registry.remove(within);
  return committed;
}

}  // namespace

Expected<void> sync_tree(const fs::path& folder) {
  // The first pass only starts the writeback, so that the disk can schedule all of it.
  for (const bool is_waiting : {false, true}) {
    std::error_code code;
    for (fs::recursive_directory_iterator entry(folder, code), end; !code && entry != end;
         entry.increment(code)) {
      if (entry->is_symlink()) continue;
      const FileDescriptor file(::open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
      if (!file.is_open()) continue;
      if (!is_waiting) {
        if (entry->is_regular_file()) {
          ::sync_file_range(file.get(), 0, 0, SYNC_FILE_RANGE_WRITE);
        }
        continue;
      }
      if (const int failure = sync_file(file.get()); failure != 0) {
        return can_not_write(entry->path(), failure);
      }
    }
    if (code) return can_not_write(folder, code);
  }
  sync_folder(folder);
  return {};
}

void sync_folder(const fs::path& folder) {
  const FileDescriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Best effort: the renames are done, and what they moved is on the disk.
  if (file.is_open()) static_cast<void>(sync_file(file.get()));
}

Expected<void> commit_sibling(const FolderCommit& commit, const CommitHooks& hooks) {
  PartialRegistry& registry = PartialRegistry::instance();
  fs::path old;
  bool is_renamable = true;
  {
    const auto lock = registry.defer_signals();
    Expected<std::optional<fs::path>> replaced = put_in_place(commit, hooks);
    if (!replaced) return replaced.error();
    is_renamable = replaced->has_value();
    old = replaced->value_or(fs::path());
    sync_folder(commit.target.parent_path());
  }
  if (!is_renamable) {
    const Expected<void> moved = move_within(commit, hooks);
    if (moved) registry.remove(commit.partial);
    return moved;
  }
  registry.remove(commit.partial);
  if (!old.empty()) {
    registry.add(old);
    hooks.before_step("remove the old folder");
    remove_partial(old);
    registry.remove(old);
  }
  hooks.before_step("end");
  return {};
}

Expected<void> commit_inside(const FolderCommit& commit, const CommitHooks& hooks) {
  PartialRegistry& registry = PartialRegistry::instance();
  const PartialNames names = PartialNames::inside(commit.target);
  const fs::path old = names.path(PartialState::old);
  {
    const auto lock = registry.defer_signals();
    std::error_code code;
    if (!movable_entries(commit.target, code).empty() || code) {
      const auto replaceable = commit.check_replaceable();
      if (!replaceable) return replaceable.error();
    }
    code = move_into_place(commit, names.path(PartialState::moving), old, hooks);
    if (code) return can_not_write(commit.target, code);
  }
  registry.remove(commit.partial);
  hooks.before_step("remove the old content");
  remove_partial(commit.partial);
  remove_partial(old);
  hooks.before_step("end");
  return {};
}

void recover_sibling(const fs::path& target) {
  for (const PartialNames::Found& found : PartialNames::sibling_of(target).find_abandoned()) {
    const fs::path old = found.path(PartialState::old);
    std::error_code ignored;
    if (!old.empty() && !path_exists(target)) fs::rename(old, target, ignored);
    for (const auto& [state, path] : found.paths) {
      // Where the target could not be restored, the old content stays.
      if (state != PartialState::old || path_exists(target)) remove_partial(path);
    }
  }
}

void recover_inside(const fs::path& target) {
  for (const PartialNames::Found& found : PartialNames::inside(target).find_abandoned()) {
    if (repair_inside(found, target)) continue;
    for (const auto& [state, path] : found.paths) remove_partial(path);
  }
}

}  // namespace pcavr
