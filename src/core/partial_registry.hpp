// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

namespace pcavr {

/// What this process has to remove if a signal ends it. One for the process, because signals are.
/// Thread-safe.
class PartialRegistry {
 public:
  static PartialRegistry& instance();

  /// `parents`, outermost first, were made for it: they are removed with it where they are empty.
  void add(const std::filesystem::path& path, std::vector<std::filesystem::path> parents = {});
  void remove(const std::filesystem::path& path);

  /// As long as it is held, no signal ends the process: for the moment in which a target is neither
  /// the old nor the new. Nothing else of the registry may be called meanwhile.
  [[nodiscard]] std::unique_lock<std::mutex> hold_off_signals();

  /// Removes all that was added. Keeps the lock: nothing can be committed afterwards.
  void remove_all_for_good();

 private:
  struct Entry {
    std::filesystem::path path;
    std::vector<std::filesystem::path> parents;
  };

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// Removes a file or tree, and then those of `parents` (outermost first) that are empty. Repeated
/// while another thread still writes into it.
void remove_partial(const std::filesystem::path& path,
                    const std::vector<std::filesystem::path>& parents = {});

}  // namespace pcavr
