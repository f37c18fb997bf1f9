// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/base/core/output_paths.hpp"

#include "base/core/folder_commit.hpp"
#include "base/core/mount_point.hpp"
#include "base/core/output_error.hpp"
#include "base/core/output_kind.hpp"
#include "base/core/partial_names.hpp"
#include "base/core/partial_registry.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// A target as it was found, before anything is written.
struct Target {
  fs::path given;
  fs::path path;           ///< resolved
  bool exists = false;     ///< as a folder
  bool is_inside = false;  ///< the temporary folder is inside the target, not a sibling
};

/// Whether this process may rename the folder: its parent is writable, and has no sticky bit (as
/// /tmp, where only an entry's owner may).
bool is_renamable(const fs::path& folder) {
  const fs::path parent = folder.parent_path();
  if (::access(parent.c_str(), W_OK | X_OK) != 0) return false;
  struct stat own {};
  struct stat above {};
  if (::stat(folder.c_str(), &own) != 0 || ::stat(parent.c_str(), &above) != 0) return false;
  const uid_t user = ::geteuid();
  return (above.st_mode & S_ISVTX) == 0 || user == 0 || user == own.st_uid || user == above.st_uid;
}

/// A shell whose working directory it is would be left in a deleted folder.
bool is_current_folder(const fs::path& folder) {
  std::error_code code;
  return fs::equivalent(folder, fs::current_path(code), code) && !code;
}

Expected<Target> find_target(const fs::path& given) {
  const Expected<fs::path> resolved = resolve_path(given);
  if (!resolved) return resolved.error();
  Target target{.given = given, .path = *resolved};
  std::error_code code;
  const fs::file_status status = fs::status(target.path, code);
  if (status.type() == fs::file_type::not_found) return target;
  if (code) return can_not_write(given, code);
  if (status.type() != fs::file_type::directory) {
    return Error{.message = "already exists, and is not a folder",
                 .file = given.string(),
                 .hint = "choose another name for the output"};
  }
  target.exists = true;
  target.is_inside = !target.path.has_relative_path() || is_mount_point(target.path) ||
                     is_current_folder(target.path) || !is_renamable(target.path);
  return target;
}

/// Entries that the file system itself keeps in a mount point (lost+found) are not counted.
bool is_empty(const Target& target, std::error_code& code) {
  for (fs::directory_iterator entry(target.path, code), end; !code && entry != end;
       entry.increment(code)) {
    const bool counts = !target.is_inside || !is_ignored_entry(entry->path().filename().string());
    if (counts) return false;
  }
  return !code;
}

Expected<void> check_content(const Target& target, const OutputFolderOptions& options) {
  if (!target.exists) return {};
  std::error_code code;
  const bool has_nothing = is_empty(target, code);
  if (code) return can_not_write(target.given, code);
  if (has_nothing) return {};
  if (!options.replace) {
    return Error{.message = "already exists, and is not empty",
                 .file = target.given.string(),
                 .hint = "choose another name, or pass --force to replace it"};
  }
  if (::access(target.path.c_str(), W_OK | X_OK) != 0) {
    return can_not_write(target.given, errno);
  }
  return check_replaceable(target.path, *options.kind);
}

/// Creates the missing parent folders of `path`, and returns them, outermost first.
std::vector<fs::path> make_parents(const fs::path& path, std::error_code& code) {
  std::vector<fs::path> made;
  for (fs::path folder = path.parent_path(); !fs::exists(folder, code) && !code;
       folder = folder.parent_path()) {
    made.push_back(folder);
  }
  // A missing folder is expected, not an error.
  if (code == std::errc::no_such_file_or_directory) code.clear();
  std::reverse(made.begin(), made.end());
  for (std::size_t i = 0; i < made.size() && !code; ++i) {
    fs::create_directory(made[i], code);
    if (code) made.resize(i);
  }
  return made;
}

}  // namespace

struct OutputFolder::State {
  Target target;
  OutputFolderOptions options;
  fs::path partial;
  std::vector<fs::path> made_parents;
  FileDescriptor lock = {};
  bool is_committed = false;

  State(Target target_in, OutputFolderOptions options_in)
      : target(std::move(target_in)), options(options_in) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (is_committed || partial.empty()) return;
    remove_partial(partial, made_parents);
    PartialRegistry::instance().remove(partial);
  }

  /// The output may have taken hours to compute: if it can't replace the target, it is kept as a
  /// sibling.
  [[nodiscard]] Error keep_as_sibling(Error error) {
    const fs::path kept = target.path.string() + ".new";
    if (::renameat2(AT_FDCWD, partial.c_str(), AT_FDCWD, kept.c_str(), RENAME_NOREPLACE) != 0) {
      return error;
    }
    PartialRegistry::instance().remove(partial);
    is_committed = true;
    error.hint = "the new output is complete, and is kept as " + kept.string();
    return error;
  }
};

Expected<OutputFolder> OutputFolder::create(const fs::path& target_in,
                                            const OutputFolderOptions& options) {
  PCAVR_REQUIRE(!options.replace || options.kind);
  if (const Expected<fs::path> path = resolve_path(target_in); path && path->has_relative_path()) {
    recover_sibling(*path);
    recover_inside(*path);
  }
  Expected<Target> target = find_target(target_in);
  if (!target) return target.error();
  const Expected<void> valid = check_content(*target, options);
  if (!valid) return valid.error();
  const PartialNames names = target->is_inside ? PartialNames::inside(target->path)
                                               : PartialNames::sibling_of(target->path);
  auto state = std::make_unique<State>(std::move(*target), options);
  const fs::path partial = names.path(PartialState::partial);
  std::error_code code;
  state->made_parents = make_parents(partial, code);
  // From here on a failure removes what was created.
  if (!code && fs::create_directory(partial, code)) {
    state->partial = partial;
    PartialRegistry::instance().add(partial, state->made_parents);
    state->lock = acquire_lock(partial);
    return OutputFolder(std::move(state));
  }
  remove_partial({}, state->made_parents);
  if (code) return can_not_write(target_in, code);
  return Error{.message = "another run is writing it", .file = target_in.string()};
}

OutputFolder::OutputFolder(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputFolder::OutputFolder(OutputFolder&& other) noexcept = default;
OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept = default;
OutputFolder::~OutputFolder() = default;

const fs::path& OutputFolder::path() const { return state_->partial; }

Expected<void> OutputFolder::commit() { return commit({}); }

Expected<void> OutputFolder::commit(const CommitHooks& hooks) {
  PCAVR_REQUIRE(state_ && !state_->is_committed);
  hooks.before_step("write to the disk");
  const Expected<void> synced = sync_tree(state_->partial);
  if (!synced) return synced;
  const Target& target = state_->target;
  const FolderCommit commit{
      .partial = state_->partial,
      .target = target.path,
      // Checked again: others may have written there during a long computation.
      .check_replaceable = [&] {
        return check_content({target.given, target.path, true, target.is_inside}, state_->options);
      }};
  const Expected<void> committed =
      target.is_inside ? commit_inside(commit, hooks) : commit_sibling(commit, hooks);
  if (!committed) return target.is_inside ? committed : state_->keep_as_sibling(committed.error());
  state_->is_committed = true;
  return {};
}

}  // namespace pcavr
