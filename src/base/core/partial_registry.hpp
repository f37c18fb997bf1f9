// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

namespace pcavr {

/// The files and folders that this process removes if a signal ends it. A singleton, because
/// signals are per process. Thread-safe.
class PartialRegistry {
 public:
  static PartialRegistry& instance();

  /// `parents`, outermost first, were created for it: they are removed with it where they are
  /// empty.
  void add(const std::filesystem::path& path, std::vector<std::filesystem::path> parents = {});
  void remove(const std::filesystem::path& path);

  /// While the lock is held, no signal ends the process: for the critical section in which a target
  /// is neither the old nor the new. No other function of the registry may be called meanwhile.
  [[nodiscard]] std::unique_lock<std::mutex> defer_signals();

  /// Removes everything that was added. Keeps the lock, so that nothing can be committed
  /// afterwards.
  void remove_all_and_lock();

 private:
  struct Entry {
    std::filesystem::path path;
    std::vector<std::filesystem::path> parents;
  };

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// Removes a file or tree, and then those of `parents` (outermost first) that are empty. Repeats
/// this while another thread still writes into it.
void remove_partial(const std::filesystem::path& path,
                    const std::vector<std::filesystem::path>& parents = {});

}  // namespace pcavr
