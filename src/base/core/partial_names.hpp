// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/file_descriptor.hpp"

namespace pcavr {

/// State of the content that is written for a target, or moved aside for it, under a hidden name in
/// one folder: `.NAME.STATE-PID`.
enum class PartialState {
  partial,  ///< new content, not complete; or old content after an exchange
  moving,   ///< some of the old content, being moved aside
  old,      ///< all of the old content, moved aside
};

class PartialNames {
 public:
  /// Names in the target's parent folder, so that a rename stays within one file system. A file's
  /// temporary name ends in its `extension`, which some libraries read the format from.
  [[nodiscard]] static PartialNames sibling_of(const std::filesystem::path& target,
                                               std::string extension = {});
  /// Names inside the target, for one that can't be renamed.
  [[nodiscard]] static PartialNames inside(const std::filesystem::path& target);
  /// Whether inside() produces this name.
  [[nodiscard]] static bool is_inside_name(std::string_view name);

  /// The path of this process.
  [[nodiscard]] std::filesystem::path path(PartialState state) const;

  /// The paths of one process that were found on the disk.
  struct Found {
    long process = 0;
    std::vector<std::pair<PartialState, std::filesystem::path>> paths;
    /// Empty where there is none of this state.
    [[nodiscard]] std::filesystem::path path(PartialState state) const;
  };
  /// Stale ones: those whose process is dead, by ascending process id.
  [[nodiscard]] std::vector<Found> find_abandoned() const;

 private:
  PartialNames(std::filesystem::path folder, std::string prefix, std::string extension);

  std::filesystem::path folder_;
  std::string prefix_;
  std::string extension_;
};

/// Opens a file or folder and locks it (flock) for this process: find_abandoned() of other
/// processes skips it until the descriptor is closed. The result is not open where the path does
/// not exist or another process holds the lock; open without a lock where the file system has
/// none.
[[nodiscard]] FileDescriptor acquire_lock(const std::filesystem::path& path);

}  // namespace pcavr
