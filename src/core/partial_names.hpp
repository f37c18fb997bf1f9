// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/file_descriptor.hpp"

namespace pcavr {

/// What is being written for a target, or moved aside for it: hidden names in one folder,
/// `.NAME.STATE-PID`.
enum class PartialState {
  partial,  ///< new content, not complete; or old content after an exchange
  moving,   ///< some of the old content, on its way aside
  old,      ///< all of the old content, moved aside
};

class PartialNames {
 public:
  /// Beside the target, so that a rename stays within one file system. A file's temporary name ends
  /// in its `extension`, which some libraries read the format from.
  [[nodiscard]] static PartialNames beside(const std::filesystem::path& target,
                                           std::string extension = {});
  /// Within the target, for one that can't be renamed.
  [[nodiscard]] static PartialNames inside(const std::filesystem::path& target);
  /// Whether this is a name that inside() gives.
  [[nodiscard]] static bool is_inside_name(std::string_view name);

  /// This process's own.
  [[nodiscard]] std::filesystem::path path(PartialState state) const;

  /// One process's, that was found on the disk.
  struct Found {
    long process = 0;
    std::vector<std::pair<PartialState, std::filesystem::path>> paths;
    /// Empty where there is none of this state.
    [[nodiscard]] std::filesystem::path path(PartialState state) const;
  };
  /// Those whose process is gone, by ascending process id.
  [[nodiscard]] std::vector<Found> find_abandoned() const;

 private:
  PartialNames(std::filesystem::path folder, std::string prefix, std::string extension);

  std::filesystem::path folder_;
  std::string prefix_;
  std::string extension_;
};

/// Opens a file or folder and locks it as this process's: find_abandoned() of other processes
/// leaves it alone until the descriptor is closed. Not open where it does not exist or another
/// holds the lock; open without a lock where the file system has none.
[[nodiscard]] FileDescriptor lock_as_own(const std::filesystem::path& path);

}  // namespace pcavr
