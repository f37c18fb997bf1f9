// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "pcavr/base/core/output_paths.hpp"

#include "base/core/file_content.hpp"
#include "base/core/file_descriptor.hpp"
#include "base/core/folder_commit.hpp"
#include "base/core/mount_point.hpp"
#include "base/core/output_error.hpp"
#include "base/core/partial_names.hpp"
#include "base/core/partial_registry.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

Expected<void> check_existing(const fs::path& given, const fs::path& target,
                              const OutputFileOptions& options) {
  std::error_code code;
  const fs::file_status status = fs::status(target, code);
  if (status.type() == fs::file_type::not_found) return {};
  if (code) return can_not_write(given, code);
  if (status.type() != fs::file_type::regular) {
    return Error{.message = fs::is_directory(status) ? "is a folder" : "is not a regular file",
                 .file = given.string(),
                 .hint = "choose another name for the output"};
  }
  if (is_mount_point(target)) {
    return Error{.message = "is a mount point, so it can't be replaced",
                 .file = given.string(),
                 .hint = "mount the folder it is in, or choose another name"};
  }
  if (!options.replace) {
    return Error{.message = "already exists",
                 .file = given.string(),
                 .hint = "choose another name, or pass --force to replace it"};
  }
  const bool is_empty = fs::file_size(target, code) == 0 && !code;
  if (is_empty || (options.is_replaceable && options.is_replaceable(target))) return {};
  return Error{.message = "already exists, and --force does not replace it: it is not a " +
                          options.kind + " of pcavr",
               .file = given.string(),
               .hint = "choose another name, or move away what is there"};
}

/// The resolved target, if it may be written.
Expected<fs::path> find_target(const fs::path& given, const OutputFileOptions& options) {
  if (!given.empty() && !given.has_filename()) {
    return Error{.message = "is not the name of a file",
                 .file = given.string(),
                 .hint = "add the file's name"};
  }
  Expected<fs::path> target = resolve_path(given);
  if (!target) return target;
  const Expected<void> existing = check_existing(given, *target, options);
  if (!existing) return existing.error();
  if (::access(target->parent_path().c_str(), W_OK | X_OK) != 0) {
    return can_not_write(given, errno);
  }
  return target;
}

bool rename_with(const fs::path& from, const fs::path& to, unsigned flags) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0;
}

}  // namespace

struct OutputFile::State {
  enum class Progress { writing, created, exchanged, replaced };

  fs::path given;
  fs::path target;
  OutputFileOptions options;
  fs::path partial;
  FileDescriptor lock = {};
  Progress progress = Progress::writing;

  State(fs::path given_in, fs::path target_in, OutputFileOptions options_in)
      : given(std::move(given_in)),
        target(std::move(target_in)),
        options(std::move(options_in)),
        partial(PartialNames::sibling_of(target, target.extension().string())
                    .path(PartialState::partial)) {
    PartialRegistry::instance().add(partial);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    // This is the new content where it was not committed, else the content that it replaced.
    remove_partial(partial);
    PartialRegistry::instance().remove(partial);
  }
};

Expected<void> OutputFile::check(const fs::path& target, const OutputFileOptions& options) {
  const Expected<fs::path> found = find_target(target, options);
  return found ? Expected<void>() : found.error();
}

Expected<OutputFile> OutputFile::create(const fs::path& given, const OutputFileOptions& options) {
  Expected<fs::path> target = find_target(given, options);
  if (!target) return target.error();
  const PartialNames names = PartialNames::sibling_of(*target, target->extension().string());
  for (const PartialNames::Found& found : names.find_abandoned()) {
    for (const auto& [ignored, path] : found.paths) remove_partial(path);
  }
  auto state = std::make_unique<State>(given, std::move(*target), options);
  if (const int failure = create_content(state->partial, {}); failure != 0) {
    return can_not_write(given, failure);
  }
  state->lock = acquire_lock(state->partial);
  return OutputFile(std::move(state));
}

OutputFile::OutputFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputFile::OutputFile(OutputFile&& other) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&& other) noexcept = default;
OutputFile::~OutputFile() = default;

const fs::path& OutputFile::path() const { return state_->partial; }

Expected<void> OutputFile::write(std::string_view content) {
  const int failure = replace_content(state_->partial, content);
  if (failure != 0) return can_not_write(state_->given, failure);
  return {};
}

Expected<void> OutputFile::append(std::string_view content) {
  const int failure = append_content(state_->partial, content);
  if (failure != 0) return can_not_write(state_->given, failure);
  return {};
}

Expected<void> OutputFile::commit() {
  State& state = *state_;
  PCAVR_REQUIRE(state.progress == State::Progress::writing);
  const FileDescriptor file(::open(state.partial.c_str(), O_RDONLY | O_CLOEXEC));
  const int failure = file.is_open() ? sync_file(file.get()) : errno;
  if (failure != 0) return can_not_write(state.given, failure);
  // Checked again: others may have written there meanwhile.
  const Expected<void> existing = check_existing(state.given, state.target, state.options);
  if (!existing) return existing;
  {
    const auto lock = PartialRegistry::instance().defer_signals();
    std::error_code code;
    if (rename_with(state.partial, state.target, RENAME_EXCHANGE)) {
      state.progress = State::Progress::exchanged;
    } else {
      const bool is_new = !fs::exists(state.target, code);
      fs::rename(state.partial, state.target, code);
      if (!code) state.progress = is_new ? State::Progress::created : State::Progress::replaced;
    }
    if (code) return can_not_write(state.given, code);
  }
  sync_folder(state.target.parent_path());
  return {};
}

void OutputFile::undo() {
  State& state = *state_;
  std::error_code ignored;
  if (state.progress == State::Progress::exchanged) {
    rename_with(state.partial, state.target, RENAME_EXCHANGE);
  } else if (state.progress == State::Progress::created) {
    fs::remove(state.target, ignored);
  }
  state.progress = State::Progress::writing;
}

}  // namespace pcavr
