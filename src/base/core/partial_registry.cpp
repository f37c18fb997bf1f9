// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/partial_registry.hpp"

#include <system_error>
#include <utility>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// The main thread may still write while a folder is being removed: the removal is repeated until
/// nothing is left, at most this often.
constexpr int kMaxAttempts = 100;

}  // namespace

PartialRegistry& PartialRegistry::instance() {
  // Never destroyed: a signal may arrive while the process exits.
  static PartialRegistry& registry = *new PartialRegistry;
  return registry;
}

void PartialRegistry::add(const fs::path& path, std::vector<fs::path> parents) {
  const std::lock_guard lock(mutex_);
  entries_.push_back({path, std::move(parents)});
}

void PartialRegistry::remove(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.path == path; });
}

std::unique_lock<std::mutex> PartialRegistry::defer_signals() { return std::unique_lock(mutex_); }

void PartialRegistry::remove_all_and_lock() {
  mutex_.lock();
  for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry) {
    remove_partial(entry->path, entry->parents);
  }
}

void remove_partial(const fs::path& path, const std::vector<fs::path>& parents) {
  std::error_code code;
  for (int i = 0; i < kMaxAttempts; ++i) {
    fs::remove_all(path, code);
    if (fs::symlink_status(path, code).type() == fs::file_type::not_found) break;
  }
  // remove() takes empty folders only.
  for (auto parent = parents.rbegin(); parent != parents.rend(); ++parent) {
    fs::remove(*parent, code);
  }
}

}  // namespace pcavr
